#pragma once

#include "filasofia/runtime/paint.h"

#include "filasofia/frame/frame.h"
#include "filasofia/mapping/map.h"
#include "filasofia/mapping/transfer.h"

#include <map>
#include <memory>
#include <mutex>
#include <optional>

namespace filasofia::runtime {

using SharedSurface = std::shared_ptr<const mapping::MappedSurface>;

/// Names one surface that is drawn. show() of a rigid body with several elements makes several.
using SurfaceKey = std::uint64_t;

/// Paints the vertices within `radius` [m] of `centre`, both at rest. Returns how many it reached.
int paint(std::span<const Vec3> rest, Vec3 centre, double radius, const visual::SurfaceState& state, PaintMode mode,
          std::vector<visual::SurfaceState>& states);

/// Finds the point of a deformed surface that is nearest to `place` and returns where it is at rest. Nothing if none is
/// within `radius`.
std::optional<Vec3> restPlace(const geometry::TriangleMesh& rest, std::span<const Vec3> now, Vec3 place, double radius);

/// The paint on every surface that is drawn. Any thread.
class PaintedSurfaces {
public:
    /// Where a surface is at rest. A soft body's surface is in the world, and `body` is the body's start pose; the
    /// surface of a rigid body's element is in that element's coordinates.
    struct Place {
        BodyId id;
        std::optional<int> element = {}; ///< index in a rigid body; nothing for a soft body
        Pose body = {};
    };
    void add(SurfaceKey key, const Place& place, SharedSurface surface);
    void forget(SurfaceKey key);

    /// Paints all surfaces of a body. `frame` says where they are now; it is null before the first step. Returns how
    /// many vertices it reached.
    int paint(BodyId id, const PaintDef& def, const frame::Frame* frame);

    /// Removes all paint.
    void clear();

    /// The vertices' states, if somebody painted since the last call.
    std::optional<std::vector<visual::SurfaceState>> takeNew(SurfaceKey key);
    /// The vertices' states; empty if nobody has painted them.
    std::vector<visual::SurfaceState> states(SurfaceKey key);
    /// Makes the next takeNew() return the states once more, unless there is no paint at all.
    void resend(SurfaceKey key);
    /// The surface has new triangles: carries the paint over to them, through one transfer after another.
    void moveTo(SurfaceKey key, SharedSurface surface, std::span<const mapping::SurfaceTransfer> transfers);

private:
    struct Painted {
        Place place;
        SharedSurface surface;
        std::vector<visual::SurfaceState> states = {}; ///< empty until somebody paints
        bool fresh = false;
    };
    static std::optional<Vec3> centre(const Painted& painted, const PaintDef& def, const frame::Frame* frame);

    std::mutex mutex_;
    std::map<SurfaceKey, Painted> painted_;
};

} // namespace filasofia::runtime
