#pragma once

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/math/pose.h"

#include <array>
#include <random>
#include <string>
#include <vector>

/// How the soak's two tools move.
namespace filasofia::app {

/// A capsule's size.
struct Capsule {
    double radius = 0.005; ///< [m]
    double half = 0.025;   ///< [m] of its straight part
};

/// Moves two capsules at random around a body, and into it: presses, scrapes, and grasps between both, at up to 1 m/s,
/// smoothly. The seed says all. Neither tool's axis is sent where the body has no room to give way: deep below its
/// surface at rest, or near where it is held.
class RandomMoves {
public:
    /// `heldBelow` [m]: the body's nodes below that height do not move.
    RandomMoves(const geometry::TetMesh& mesh, double heldBelow, Capsule capsule, int seed);

    /// Where both are at that time; times ascend.
    std::array<Pose, 2> at(double time);
    /// From then on both go straight out of the body's way, and stay there.
    void leave(double time);
    /// What they are at: "press", "scrape", "grasp".
    [[nodiscard]] const std::string& doing() const { return doing_; }
    /// Where they are out of the body's way, the second tool's place while it has nothing to do.
    [[nodiscard]] Pose parked(int tool) const;

private:
    struct Move {
        std::array<Pose, 2> to = {};
        double speed = 0.0; ///< [m/s] at most, of any point of a tool
        double rest = 0.0;  ///< [s] afterwards
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
    double heldBelow_;
    Capsule capsule_;
    std::mt19937 source_;
    std::vector<Move> moves_; ///< the first is under way
    std::array<Pose, 2> from_;
    double begun_ = 0.0; ///< [s]
    std::string doing_;
};

} // namespace filasofia::app
