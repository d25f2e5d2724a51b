#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/frame/clip.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/surface/duct_def.h"

#include <cstdint>
#include <span>

namespace filasofia::surface {

/// A body that a duct runs through, after a step.
struct DuctBody {
    std::span<const Vec3> positions = {};      ///< [m] where its nodes are
    const frame::Boundary* boundary = nullptr; ///< its boundary after cuts; null or revision 0: it is whole
    std::span<const frame::Clip> clips = {};   ///< on this body
};

/// The flow in a tube that tissue surrounds: Poiseuille's law for the ellipse that the tube is, place by place.
///
/// At stations along its path it follows rings of points in the tissue. A ring has half axes a and b, by its second
/// moments and its area; over a length L, pi p a^3 b^3 / (4 eta L (a^2 + b^2)) flows (White, Viscous Fluid Flow,
/// equation 3-47). It is cut where the surface of the body has fallen into parts between two stations.
class Duct {
public:
    /// `mesh`: the body's at the start, in the world; `skin`: its boundary then. Throws an Error that begins with
    /// `object` if the path is shorter than the radius or longer than 100 m, turns sharply, or leads away from the
    /// body, or if the tube is wider than the body.
    Duct(const DuctDef& def, const geometry::TetMesh& mesh, std::span<const geometry::Triangle> skin,
         const std::string& object);

    /// What flows now, and in a step of dt [s].
    void step(const DuctBody& body, double dt);
    [[nodiscard]] const DuctBalance& balance() const { return balance_; }
    [[nodiscard]] const DuctDef& def() const { return def_; }

    /// An end that a cut has made.
    struct End {
        Vec3 place = {};   ///< [m] near it
        double leak = 0.0; ///< [m^3/s]; 0: it is shut, or nothing presses there
    };
    [[nodiscard]] const std::vector<End>& ends() const { return ends_; } ///< the inlet's part, then the outlet's
    [[nodiscard]] std::uint64_t revision() const { return revision_; }   ///< the last that it saw
    void restart();                                                      ///< it is whole, and has seen nothing

private:
    void follow(std::span<const Vec3> positions);
    void measureConductances();
    /// The station that a clip is at; -1 if it is on none.
    [[nodiscard]] int stationOf(const frame::Clip& clip) const;
    [[nodiscard]] double resistance(int from, int to) const;
    void flowThrough(DuctBalance& now) const;
    void leakOut(const DuctBody& body, double dt, DuctBalance& now);
    [[nodiscard]] int lastStation() const { return static_cast<int>(middles_.size()) - 1; }
    void findCut(const DuctBody& body);
    void findNear(const geometry::TetMesh& mesh, std::span<const geometry::Triangle> skin, std::span<const Vec3> points,
                  const std::string& object);

    DuctDef def_;
    double spacing_ = 0.0;                     ///< [m] between two stations
    geometry::Embedding points_;               ///< the points of all rings, station by station
    std::vector<int> near_;                    ///< per point, the nearest node of the skin, all on one of its walls
    std::vector<Vec3> middles_;                ///< [m] where the stations are now
    std::vector<Vec3> ring_;                   ///< [m] where the points are now
    std::vector<double> open_;                 ///< [-] per station, flow per pressure over that at the start
    std::vector<int> clipped_;                 ///< stations that clips are at
    std::uint64_t revision_ = 0;               ///< the boundary that cuts_ was found in
    std::vector<int> cuts_;                    ///< it is cut between each of these stations and the next
    std::array<std::vector<int>, 2> endNodes_; ///< nodes of the skin, around the cut ends
    std::vector<End> ends_;
    DuctBalance balance_;
};

} // namespace filasofia::surface
