#pragma once

#include "filasofia/physics/commands.h"
#include "filasofia/physics/step.h"

#include <array>
#include <functional>
#include <vector>

namespace filasofia::physics {

/// How a dynamic body moves now.
struct BodyMotion {
    BodyId body = {};
    double speed = 0.0;     ///< [m/s] its fastest point
    double kinetic = 0.0;   ///< [J]
    double potential = 0.0; ///< [J] in gravity
};

/// Adds an element of a rigid body. Its speed is the root mean square one that has its energy. `gravity`: none if the
/// body does not fall.
void addElement(const RigidInertia& inertia, const Pose& pose, Vec3 velocity, Vec3 angularVelocity, Vec3 gravity,
                BodyMotion& motion);

/// Finds bodies that go on moving though nothing drives them, whatever engine moves them.
///
/// Motion is judged over windows of a second, beginning a second after the last drive. A body is restless if its
/// fastest point has moved faster than kAtRest, in the root mean square, in each of four windows, and in the last one
/// at least kSustained times as fast as in any before: motion that damping brakes is none of these. It gains energy if,
/// besides, its mean kinetic energy has grown by more than kGain in each of three windows in a row, and by more than it
/// has fallen. What elastic bodies store is not counted.
class MotionWatch {
public:
    static constexpr double kWindow = 1.0;     // [s]
    static constexpr double kAtRest = 1e-3;    // [m/s]
    static constexpr double kSustained = 0.95; // [-]
    static constexpr double kGain = 0.1;       // [-]

    /// Called at the end of a step of dt [s]. `driven`: something drove the scene in it. `motions` gives the motion of
    /// each dynamic body, the same bodies in the same order until the next drive; it is not always asked.
    void follow(bool driven, double dt, const std::function<std::vector<BodyMotion>()>& motions, StepReport& report);

private:
    /// The motion of a dynamic body: sums over a window, or means.
    struct Motion {
        BodyId body;
        double speed2 = 0.0;             ///< [m^2/s^2] the square of the speed of its fastest point
        double kinetic = 0.0;            ///< [J]
        double potential = 0.0;          ///< [J] in gravity
        std::array<double, 3> earlier{}; ///< [m^2/s^2] speed2 of the three windows before
        int gains = 0;                   ///< windows in a row in which it gained energy
        bool restless = false;
    };

    void add(double dt, const std::vector<BodyMotion>& motions);
    void endWindow();

    double undriven_ = 0.0;             ///< [s] since the last drive
    double window_ = 0.0;               ///< [s] the present window
    std::vector<Motion> sums_, before_; ///< the present window; means of the one before, empty if there is none
};

/// Whether a command drives a scene in another way than by what it sets: poses, hands, wrenches, forces, pressures,
/// joints, curvatures and gravity drive it only if they change, which an engine sees in its state.
bool changesScene(const Command& command);

} // namespace filasofia::physics
