#pragma once

#include "apps/hysteroscopy/patient.h"

/// Planned motions, for tests, pictures and figures.
namespace hysteroscopy {

struct Motion {
    const Patient& patient;
    const filasofia::ScopeHands& hands;
    filasofia::ArticulatedInstrument& forceps;
    std::function<filasofia::Vec3()> middle; ///< the present position of the polyp's head
    /// Takes a picture of that name; empty if no pictures are wanted.
    std::function<std::function<void()>(const char* name)> picture;
    std::function<void()> flush; ///< opens the outflow of the fluid wide
};

/// Enters, looks around, grasps the polyp, tears it off and brings it out.
std::vector<filasofia::HandMove> expertMotion(const Motion& with);
/// Moves about at random, mostly too far, snaps at the polyp and leaves. Every seed gives another motion.
std::vector<filasofia::HandMove> clumsyMotion(const Motion& with, std::uint64_t seed);

} // namespace hysteroscopy
