#pragma once

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/math/pose.h"

#include <array>
#include <random>
#include <string>
#include <vector>

/// Motions of the soak's two tools.
namespace filasofia::app {

/// The size of a capsule.
struct Capsule {
    double radius = 0.005; ///< [m]
    double half = 0.025;   ///< [m] half the length of the straight part
};

/// Moves two capsules at random around a body and into it: presses, scrapes, and grasps with both, smoothly and at up
/// to 1 m/s. The seed determines everything. Neither tool's axis enters regions where the body has no room to yield:
/// deep below its surface at rest, or near its pinned part.
class RandomMoves {
public:
    /// `pinnedBelow` [m]: the body's nodes below that height are pinned.
    RandomMoves(const geometry::TetMesh& mesh, double pinnedBelow, Capsule capsule, int seed);

    /// The poses of both tools at a time. Calls must have ascending times.
    std::array<Pose, 2> at(double time);
    /// From this time on both tools move straight out of the body's way and stay there.
    void leave(double time);
    /// The current action: "press", "scrape" or "grasp".
    [[nodiscard]] const std::string& doing() const { return doing_; }
    /// A pose out of the body's way; the second tool waits there if it has nothing to do.
    [[nodiscard]] Pose parked(int tool) const;

private:
    struct Move {
        std::array<Pose, 2> to = {};
        double speed = 0.0; ///< [m/s] the highest speed of any point of a tool
        double rest = 0.0;  ///< [s] pause afterwards
    };
    struct Place {
        Vec3 point, normal;
    };

    void plan();
    bool planTouch();
    bool planGrasp();
    void travel(std::array<Pose, 2> to);
    [[nodiscard]] bool fits(const Pose& pose) const;
    [[nodiscard]] bool fitsAlong(const Pose& from, const Pose& to) const;
    [[nodiscard]] double depthOf(Vec3 point) const;
    [[nodiscard]] double thickness(const Place& place, Place& exit) const;
    [[nodiscard]] double lengthOf(const Move& move) const;
    [[nodiscard]] Pose outside(const Pose& pose) const;
    Place randomPlace();
    Vec3 randomDirection();
    double random(double low, double high);

    geometry::TetMesh mesh_;
    geometry::TriangleMesh surface_;
    geometry::Bvh triangles_, tetrahedra_;
    Vec3 middle_;
    double pinnedBelow_;
    Capsule capsule_;
    std::mt19937 source_;
    std::vector<Move> moves_; ///< the first one is being executed
    std::array<Pose, 2> from_;
    double begun_ = 0.0; ///< [s]
    std::string doing_;
};

} // namespace filasofia::app
