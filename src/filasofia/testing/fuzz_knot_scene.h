#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/defs.h"
#include "filasofia/testing/fuzz_random.h"

#include <optional>
#include <vector>

namespace filasofia::testing {

/// The kinds of scenes of threads; from Needle on those of tools.
enum class KnotKind { Threads, Rings, Overhand, Surgeon, Bars, Tissue, Needle, Jaws, Around, count_ };
inline constexpr KnotKind kFirstKnotToolKind = KnotKind::Needle;
const char* name(KnotKind kind);

/// A kinematic body that moves from one random place near its home to the next.
struct FuzzHand {
    std::size_t body = 0; ///< index in KnotScene::bodies
    Vec3 home = {};       ///< [m]
    double reach = 0.0;   ///< [m]
    bool turns = false;   ///< turns as well
    double opens = 0.0;   ///< [m] jaws: its two elements are at this distance at first,
    double closed = 0.0;  ///< [m] and at this one once they have closed, along y

    Pose now = {};
    Vec3 target = {};
    Vec3 axis{0, 0, 1};
    double speed = 0.0; ///< [m/s]; 0: it pauses
    double until = 0.0; ///< [s] when it chooses again at the latest
    void move(double time, double dt, FuzzRandom& random);
    /// One of the two jaws, which close within 0.1 s: its place and motion.
    [[nodiscard]] Pose jaw(int which, double time) const;
};

/// A jaw that grasps what it touches of a body.
struct FuzzGrasp {
    double time = 0.0; ///< [s]
    std::size_t jaw = 0, target = 0;
};

/// A line that threads must not pass through: a thread's own, the axis of a bar, or that of a soft cylinder.
struct FuzzLine {
    std::size_t body = 0;                        ///< index in KnotScene::bodies
    bool closed = false;                         ///< a ring
    std::vector<Vec3> axis = {};                 ///< [m] in a rigid body's coordinates; empty: not rigid
    std::optional<std::size_t> thread = {};      ///< that goes on where the axis, of a needle, ends
    std::vector<std::vector<int>> sections = {}; ///< a soft cylinder's: nodes whose middles are the line

    /// Tools meet tools as they like.
    [[nodiscard]] bool isTool() const { return !axis.empty() && !thread; }
};

/// A scene for a FuzzStage.
struct KnotScene {
    std::vector<physics::BodyDef> bodies;
    std::vector<FuzzHand> hands;
    std::vector<FuzzLine> lines;
    std::vector<std::size_t> tissues; ///< indices in `bodies`
    std::vector<FuzzGrasp> grasps;
    double radius = 0.0; ///< [m] radius that all threads have
};
KnotScene knotScene(KnotKind kind, FuzzRandom& random);

} // namespace filasofia::testing
