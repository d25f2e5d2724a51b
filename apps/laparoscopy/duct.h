#pragma once

#include <filasofia/filasofia.h>

#include <array>
#include <vector>

/// A duct of soft tissue with an opening on its upper side, and a catheter that lies in its introducer. The duct's own
/// coordinates are x along it from the opening on, y through the opening to the outside, and z across, from the middle
/// of its lumen under the opening.
namespace cannulating {

inline constexpr double kLumen = 3e-3;                   ///< [m], radius of the duct, inside
inline constexpr double kWall = 1.2e-3;                  ///< [m]
inline constexpr double kOpening = 6e-3;                 ///< [m]; cells with their middles in it are open: 5 x 3 mm
inline constexpr double kCatheter = 0.8e-3;              ///< [m], its radius: 5 Fr
inline constexpr double kOutside = kLumen + 0.5 * kWall; ///< [m], what is farther from the middle is not in the lumen
inline constexpr double kMarks[] = {15e-3, 20e-3};       ///< [m], from its tip

/// A place in the duct.
struct Place {
    double along = 0.0; ///< [m], from the opening on
    double away = 0.0;  ///< [m], from the middle of the lumen
};

struct Duct {
    filasofia::Pose pose = {}; ///< where its own coordinates are, at rest
    filasofia::BodyId wall = {}, catheter = {}, marks = {};
    std::vector<std::vector<int>> rings = {}; ///< nodes around the lumen, from one end to the other

    [[nodiscard]] Place place(const filasofia::frame::Frame& now, filasofia::Vec3 point) const;
    [[nodiscard]] filasofia::Vec3 tip(const filasofia::frame::Frame& now) const; ///< [m], the catheter's
    /// [m], the middle of the catheter so far behind its tip; and the direction towards the tip there.
    [[nodiscard]] filasofia::Vec3 at(const filasofia::frame::Frame& now, double behind) const;
    [[nodiscard]] filasofia::Vec3 forward(const filasofia::frame::Frame& now, double behind) const;
    /// [m], how far the tip is beyond the opening, with all of the catheter between them in the lumen; otherwise 0.
    [[nodiscard]] double depth(const filasofia::frame::Frame& now) const;
};
/// Adds duct, table, introducer and catheter. Each seed has another place and another angle of the duct.
Duct addDuct(filasofia::Simulation& sim, std::uint64_t seed);

/// The task as a whole: one session.
int cannulation(const filasofia::Training& training);
std::vector<filasofia::TrainerSetting> settings(); ///< what its case files may change

} // namespace cannulating
