#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace filasofia::testing {

/// The parameters of a fuzzing run of elastic laws.
struct LawFuzzDef {
    std::uint64_t seed = 1;
    int scenes = 200;                              ///< [-], > 0
    int first = 0;                                 ///< [-], >= 0: number of the first scene
    std::string law = {};                          ///< only scenes of this kind, see lawFuzzKinds(); all if empty
    bool fibres = false;                           ///< only scenes whose tissue begins with fibres
    std::function<void(int scenes)> progress = {}; ///< called after every scene
};

/// The kinds of scenes in the order of their numbers: scene n is of kind n modulo their number.
std::vector<std::string> lawFuzzKinds();

/// The scenes of one law.
struct LawFuzzKind {
    std::string name = {};
    long scenes = 0, steps = 0;
    long strokes = 0;       ///< [-] blades that were led through tissue
    long cuts = 0;          ///< [-] cuts of a body in a step
    long tears = 0;         ///< [-] tears of a body in a step
    long inverted = 0;      ///< [-] scenes with elements inside out
    long stillInverted = 0; ///< [-] scenes that ended with elements inside out
    long notConverged = 0;  ///< [-] steps with StepFlag::NotConverged
    long cutShort = 0;      ///< [-] scenes that ended early, after 25 such steps
    long gained = 0;        ///< [-] scenes that gained energy while nothing drove them, flagged or not
    long undone = 0;        ///< [-] scenes with StepFlag::Undone
};

/// The result of a fuzzing run of elastic laws.
struct LawFuzzReport {
    double seconds = 0.0; ///< [s] simulated, without the replays
    long scenes = 0, steps = 0;
    std::vector<LawFuzzKind> kinds = {};
    long fibres = 0, relaxing = 0, flowing = 0, regions = 0, nearlyIncompressible = 0; ///< [-] scenes with such tissue
    long grasps = 0, pulls = 0, presses = 0, changes = 0; ///< [-] a change is one of tissue, fibre stress or material
    long silentInverted = 0;   ///< [-] steps with elements inside out at their start, without StepFlag::Inverted
    long silentStrain = 0;     ///< [-] the same of elements strained beyond their range, and StepFlag::BeyondStrain
    long silentGain = 0;       ///< [-] scenes that gained energy while nothing drove them, without a flag before
    double mostSilent = 0.0;   ///< [-] by how much these gained at most, relative to the energy that they had
    long massChanged = 0;      ///< [-] scenes in which a body's mass changed
    long notFinite = 0;        ///< [-] steps after which a place or a velocity was not finite
    long replays = 0;          ///< [-] recordings replayed with 2 or 8 threads
    long hashesThatDiffer = 0; ///< [-] those with another hash in some step, or refused
    int median = 0, percentile99 = 0, most = 0; ///< [-] iterations of a step, of the solve with the most
    std::vector<std::string> examples = {};     ///< scene, time and what happened; at most 40
    std::uint64_t hash = 0;

    [[nodiscard]] bool sound() const
    {
        return silentInverted + silentStrain + silentGain + massChanged + notFinite + hashesThatDiffer == 0;
    }
};

/// Cuts, tears, grasps, pulls and presses small bodies of every elastic law and shells, at 100 to 4,000 steps a second.
/// Tissue has random constants, and by chance fibres, relaxation, plastic flow, regions and nearly incompressible
/// parts; commands change it during the run. Scenes run on one thread, are recorded into a file, and are replayed from
/// it with 2 or 8 threads: the hash of every step must be the same. After the last act all tools and the floor are
/// gone, and the energy of motion, weight and strain must not grow by more than 5 %, unless a flag said before that a
/// solver did not converge, a state was restored, or elements were inside out. Energy is not checked where muscle
/// contracts, nor in scenes that end early; tissue that relaxes may give back what it has stored. The same seed gives
/// the same report everywhere. A scene keeps its number if others are left out: `scenes` are counted without these.
LawFuzzReport fuzzLaws(const LawFuzzDef& def);

} // namespace filasofia::testing
