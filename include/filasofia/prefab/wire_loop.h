#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <memory>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// The loop of a resectoscope: a U of wire across the end of two arms, which lie along +Z. Its coordinates begin in the
/// middle between the arms' ends; the U hangs from there towards -Y, where an inclined scope looks.
struct WireLoopDef {
    std::string name = "loop";
    Pose pose = {};        ///< at the start, in the world
    double width = 6e-3;   ///< [m], > 0, between the arms
    double depth = 4e-3;   ///< [m], >= width / 2, from the arms to the bottom of the U, which is half a circle
    double wire = 0.3e-3;  ///< [m], > 0, thickness
    double arms = 0.03;    ///< [m], > 0, length of the arms
    double cutting = 60.0; ///< [W], in (0, 1e6], that tissue takes while the yellow pedal is pressed
    double drying = 20.0;  ///< [W], in (0, 1e6], that tissue takes while the blue one is pressed
    double reach = 1e-3;   ///< [m], in (0, 1], how far from the middle of the wire tissue is heated by either
    std::vector<int> groups = {
        0};                    ///< collision groups: what it cuts, and what it pushes if it does not; empty: nothing
    double proximity = 0.1e-3; ///< [m], >= 0, distance at which contacts are found
    double friction = 0.1;     ///< [-], >= 0, coefficient of friction
    visual::Material material = visual::MetalMaterial{.roughness = 0.4};
};
constexpr auto fields(const WireLoopDef*)
{
    using T = WireLoopDef;
    return describe(
        "WireLoopDef", field("name", &T::name, "what errors and reports call it"),
        field("pose", &T::pose, "pose at the start"), field("width", &T::width, "m", positive(), "between the arms"),
        field("depth", &T::depth, "m", positive(), "from the arms to the bottom of the loop"),
        field("wire", &T::wire, "m", positive(), "thickness"),
        field("arms", &T::arms, "m", positive(), "length of the arms"),
        field("cutting", &T::cutting, "W", openClosed(0, 1e6), "power of the yellow pedal"),
        field("drying", &T::drying, "W", openClosed(0, 1e6), "power of the blue pedal"),
        field("reach", &T::reach, "m", openClosed(0, 1), "how far from the wire tissue is heated"),
        field("groups", &T::groups, "collision groups"),
        field("proximity", &T::proximity, "m", nonNegative(), "distance at which contacts are found"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction), "mu of Coulomb's law"),
        field("material", &T::material, "what it looks like"));
}

/// A wire loop that cuts with current and shaves chips off tissue. It is a kinematic rigid body with two electrodes. A
/// working element slides it along its Z axis: give move() the pose in front of a scope's channel, or let ScopeHands do
/// it.
///
/// Its blade is the U and the straight line between the arms, so that tissue deeper than `depth` is cut off above, too.
/// Without the yellow pedal it does not cut, and pushes like a plate. Tissue that shall follow its curve needs edges of
/// at most a quarter of `width`. Every function may be called from any thread and takes effect at the next step.
class WireLoop {
public:
    static constexpr int kCuts = 0;  ///< electrode of the yellow pedal
    static constexpr int kDries = 1; ///< electrode of the blue one

    /// Adds and shows the body. Throws an Error if the Def is wrong. Construct it before a run and destroy it before
    /// the simulation.
    WireLoop(runtime::Simulation& simulation, const WireLoopDef& def = {});
    ~WireLoop();
    WireLoop(const WireLoop&) = delete;
    WireLoop& operator=(const WireLoop&) = delete;

    [[nodiscard]] BodyId body() const;
    [[nodiscard]] const WireLoopDef& def() const;
    /// [m], along the middle of the wire from arm to arm, in its own coordinates.
    [[nodiscard]] const std::vector<Vec3>& line() const;

    void move(const Pose& pose);
    void cut(bool on);               ///< presses or releases the yellow pedal
    void dry(bool on);               ///< the blue one, which coagulates
    [[nodiscard]] Pose pose() const; ///< the last pose given to move()

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's memories
};

} // namespace filasofia::prefab
