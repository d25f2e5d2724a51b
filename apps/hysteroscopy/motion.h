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

struct ResectionMotion {
    const Patient& patient;
    const filasofia::ScopeHands& hands;
    filasofia::WireLoop& loop;
    std::function<filasofia::Vec3()> root;                          ///< the present place of the myoma's root
    std::function<std::vector<filasofia::Vec3>()> surface;          ///< points of what is still on its root
    std::function<double(filasofia::Vec3)> wall;                    ///< [m] how deep a place is in the wall now
    std::function<std::function<void()>(const char* name)> picture; ///< as above
    std::function<void()> flush;
};

/// Enters, shaves the myoma off in strokes towards the scope, layer by layer and as long as it is there, and leaves.
std::vector<filasofia::HandMove> expertResection(const ResectionMotion& with);
/// Draws the loop about at random, often too deep, with current and without, and leaves.
std::vector<filasofia::HandMove> clumsyResection(const ResectionMotion& with, std::uint64_t seed);

} // namespace hysteroscopy
