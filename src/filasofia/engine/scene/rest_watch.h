#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/physics_engine.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// Finds bodies that go on moving though nothing drives them. What drives a scene are commands that change it, tools
/// and hands that move, forces and pressures that change, and ruptures.
///
/// Motion is judged over windows of a second, beginning a second after the last drive. A body is restless if its
/// fastest point has moved faster than kAtRest, in the root mean square, in each of four windows, and in the last one
/// at least kSustained times as fast as in any before: motion that damping brakes is none of these. It gains energy if,
/// besides, its mean kinetic energy has grown by more than kGain in each of three windows in a row, and by more than it
/// has fallen. What elastic bodies store is not counted.
class RestWatch {
public:
    static constexpr double kWindow = 1.0;     // [s]
    static constexpr double kAtRest = 1e-3;    // [m/s]
    static constexpr double kSustained = 0.95; // [-]
    static constexpr double kGain = 0.1;       // [-]

    /// Called at the end of a step, with the commands that it began with.
    void follow(const physics::StepInput& in, const Scene& scene, physics::StepReport& report);

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

    void addMotions(double dt, const Scene& scene);
    void endWindow();

    std::uint64_t drive_ = 0;           ///< hash of what drove the last step
    double undriven_ = 0.0;             ///< [s] since the last drive
    double window_ = 0.0;               ///< [s] of the present window
    std::vector<Motion> sums_, before_; ///< of the present window; means of the one before, empty if there is none
};

} // namespace filasofia::engine
