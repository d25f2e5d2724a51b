#pragma once

#include "apps/hysteroscopy/patient.h"

/// Planned motions, for tests, pictures and figures.
namespace hysteroscopy {

struct Motion {
    const Patient& patient;
    const filasofia::ScopeHands& hands;
    filasofia::ArticulatedInstrument& forceps;
    std::function<filasofia::Vec3()> middle; ///< where the polyp's head is now
    /// What takes a picture of that name; nothing where nobody wants any.
    std::function<std::function<void()>(const char* name)> picture;
};

/// Enters, looks around, grasps the polyp, tears it off and brings it out.
std::vector<filasofia::HandMove> expertMotion(const Motion& with);
/// Pushes about at random, mostly too far, snaps at the polyp and leaves; another way for every seed.
std::vector<filasofia::HandMove> clumsyMotion(const Motion& with, std::uint64_t seed);

} // namespace hysteroscopy
