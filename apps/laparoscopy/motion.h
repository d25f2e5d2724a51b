#pragma once

#include "apps/laparoscopy/box.h"

/// Planned motions, for tests, pictures and figures.
namespace laparoscopy {

struct Motion {
    filasofia::Simulation& sim;
    const PegBox& box;
    std::array<filasofia::LaparoscopicInstrument*, 2> tools; ///< by side
    bool back = false;                                       ///< whether the rings go back again
    /// Takes a picture of that name; empty if no pictures are wanted.
    std::function<std::function<void()>(const char* name)> picture;
};

/// Takes each ring from its peg with one hand, gives it to the other in the air, and puts it onto a peg of that side.
std::vector<filasofia::TrocarMove> expertMotion(const Motion& with);
/// Snaps at rings more or less where they are, carries them about and lets them go. Every seed gives another motion.
std::vector<filasofia::TrocarMove> clumsyMotion(const Motion& with, std::uint64_t seed);

} // namespace laparoscopy
