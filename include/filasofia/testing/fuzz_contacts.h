#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace filasofia::testing {

/// The parameters of a fuzzing run of contacts.
struct ContactFuzzDef {
    std::uint64_t seed = 1;
    int scenes = 200;                              ///< [-], > 0
    int first = 0;                                 ///< [-], >= 0: number of the first scene
    double calm = 2.0;                             ///< [s], > 0: after which what nothing drives should be at rest
    bool tools = false;                            ///< blades, threads and needles, in place of the scenes without them
    bool twice = false;                            ///< run every scene a second time and compare the hashes
    std::function<void(int scenes)> progress = {}; ///< called after every scene
};

/// One kind of scene.
struct ContactFuzzKind {
    std::string name = {};
    long scenes = 0, steps = 0;
    long notConverged = 0; ///< [-] steps with StepFlag::NotConverged
    long overlapping =
        0; ///< [-] scenes in which two bodies passed through each other by a quarter of a millimetre, flagged or not
    long inverted = 0; ///< [-] scenes with elements inside out, flagged or not
    long restless = 0; ///< [-] scenes in which something moved faster than 1 mm/s at the end
    long crowded = 0;  ///< [-] scenes at the end of which surfaces still passed through each other
    long passes = 0;   ///< [-] times that a thread passed through a thread or itself
};

/// The result of a fuzzing run of contacts.
struct ContactFuzzReport {
    double seconds = 0.0; ///< [s] simulated
    long scenes = 0, steps = 0;
    std::vector<ContactFuzzKind> kinds = {};
    long silentOverlaps = 0;   ///< [-] pairs that passed through each other for 30 ms without StepFlag::Intersecting
    long passes = 0;           ///< [-] times that a thread passed through a thread or itself
    long silentInverted = 0;   ///< [-] looks at elements inside out without StepFlag::Inverted
    long gained = 0;           ///< [-] scenes that gained energy without a flag while nothing drove them
    double mostGained = 0.0;   ///< [-] by how much at most, relative to what it was when nothing drove them any more
    long notFinite = 0;        ///< [-] steps after which a place or a velocity was not finite
    long undone = 0;           ///< [-] steps with StepFlag::Undone
    long hashesThatDiffer = 0; ///< [-] scenes whose second run gave another hash
    double deepest = 0.0;      ///< [m] deepest overlap that the checker found
    int median = 0, percentile99 = 0, most = 0; ///< [-] iterations of a step, of the solve with the most
    std::vector<std::string> examples = {};     ///< scene, time and what happened; at most 40
    std::uint64_t hash = 0;

    [[nodiscard]] bool sound() const
    {
        return silentOverlaps + passes + silentInverted + gained + notFinite + undone + hashesThatDiffer == 0;
    }
};

/// Drops, heaps, presses, squeezes and drapes bodies at random: tissue of 300 Pa to 1 MPa, sheets, shells, vessels and
/// rigid boxes, with tools of up to 1 m/s, at 100 to 4000 steps a second. With `tools`: blades that cut organs and
/// sheets, threads and rings that fall, that hands draw across tissue and tools and hold there, and needles with
/// threads.
///
/// Every 10 ms it looks whether surfaces, and the axes of threads, pass through each other, by a test of its own
/// (surface_overlap.h), and whether the flags of the step say so. In tissue with channels needle and thread may be as
/// long as those are. Threads that pass through threads are counted after each step (linking.h).
///
/// Without tools, the energy is that of places and velocities alone, without what is stored in strain or spin: if that
/// is more than all there was at the start, energy came from nowhere. With tools, it may not exceed what the engine
/// says there was when they stopped, strain included. The same seed gives the same report everywhere.
ContactFuzzReport fuzzContacts(const ContactFuzzDef& def);

} // namespace filasofia::testing
