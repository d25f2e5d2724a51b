#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/runtime/simulation.h"

#include <string>
#include <vector>

namespace filasofia::prefab {

constexpr double kStill = 0.1;  ///< [s] a throw is tight once hands at full force have not moved for so long,
constexpr double kCreep = 2e-3; ///< [m/s] that is, have been slower than this
constexpr double kRamp = 0.2;   ///< [s] in which a force grows to its full value

/// A unit vector turned towards another one, by at most an angle [rad].
Vec3 turnedTowards(Vec3 from, Vec3 to, double most);

/// A hand that holds a node of a rod by a spring and draws at its strand, away from an origin.
struct StrandHand {
    BodyId body = {};
    AttachmentId grip = {};
    Vec3 direction = {}; ///< [-] from the origin
    double away = 0.0;   ///< [m] from the origin
    double side = 1.0;   ///< 1 or -1, along `across` of the knot

    void place(Vec3 at, Vec3 origin, Vec3 up); ///< says where it is; `up` is its direction if it is at the origin
    void moveBy(double way);                   ///< [m] away from the origin
    [[nodiscard]] Vec3 at(Vec3 origin) const { return origin + away * direction; }
    [[nodiscard]] double tension(const frame::Frame& now) const; ///< [N] in the last step, along its direction
    [[nodiscard]] double pull(const frame::Frame& now) const;    ///< [N] the same in whatever direction
};

/// By how much [m] a hand moves along its strand in a step in which it wants this force [N]; at most `most`.
double drawnBy(double missing, double stiffness, double most);

/// The rod's Def and the two nodes that are held. Throws an Error that begins with `object` if the body is no rod or
/// the nodes are not two of its nodes; none given: its ends.
std::vector<int> heldNodes(runtime::Simulation& simulation, BodyId thread, std::vector<int> nodes,
                           const std::string& object);
/// Makes `up` a unit vector, and `across` one at right angles to it. Throws an Error if they are parallel, or 0.
void makeAxes(Vec3& up, Vec3& across, const std::string& object);

} // namespace filasofia::prefab
