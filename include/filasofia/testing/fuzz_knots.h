#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace filasofia::testing {

/// The parameters of a fuzzing run of knots.
struct KnotFuzzDef {
    std::uint64_t seed = 1;
    double seconds = 20.0; ///< [s], > 0: simulated time, of all scenes together
    double perScene = 2.0; ///< [s], > 0: simulated time of a scene
    double step = 1e-3;    ///< [s], > 0
    int first = 0;         ///< [-], >= 0: number of the first scene
    bool tools = false;    ///< needles, jaws and soft cylinders, in place of the scenes without them
    bool twice = false;    ///< run every scene a second time and compare the hashes
    std::function<void(double seconds)> progress = {}; ///< called after every scene
};

/// One kind of scene.
struct KnotFuzzKind {
    std::string name = {};
    long scenes = 0, steps = 0;
    long passes = 0;       ///< [-] threads through threads, themselves, bars, needles, jaws, cylinders
    long notConverged = 0; ///< [-] steps with StepFlag::NotConverged
};

/// The result of a fuzzing run of knots.
struct KnotFuzzReport {
    double seconds = 0.0; ///< [s] simulated
    long scenes = 0, steps = 0;
    std::vector<KnotFuzzKind> kinds = {};
    long passes = 0;           ///< [-] threads through threads, themselves, bars, needles, jaws, cylinders
    long looseEnds = 0;        ///< [-] scenes in which a thread left the tail of its needle by two diameters
    long linkingChanges = 0;   ///< [-] pairs of rings whose linking number was another one, or no whole number
    long linkingTests = 0;     ///< [-] linking numbers computed
    long insideTissue = 0;     ///< [-] nodes found deeper than two diameters in tissue, every 10 ms
    long notFinite = 0;        ///< [-] steps after which a place or a velocity was not finite
    long undone = 0;           ///< [-] steps with StepFlag::Undone
    long notConverged = 0;     ///< [-] steps with StepFlag::NotConverged
    long hashesThatDiffer = 0; ///< [-] scenes whose second run gave another hash
    long mostContacts = 0;     ///< [-] that pushed in one step
    double deepest = 0.0;      ///< [-] deepest overlap that the engine reported, over the thread's diameter
    int median = 0, percentile99 = 0, most = 0; ///< [-] iterations of a step, of the body with the most
    std::vector<std::string> examples = {};     ///< scene, time and what happened; at most 20
    std::uint64_t hash = 0;

    [[nodiscard]] bool sound() const
    {
        return passes + looseEnds + linkingChanges + insideTissue + notFinite + undone + hashesThatDiffer == 0;
    }
};

/// Ties and pulls threads at random: threads and rings with held ends, knots, threads around bars and over tissue, with
/// random radii, moduli and friction, drawn by hands that move with up to 1 m/s. With `tools`: a curved needle with a
/// thread among threads, jaws that hold a thread and pull it, threads and rings around a soft cylinder. After each step
/// it counts passes from the points of the lines alone: centre lines of threads, axes of tools, the middles of the
/// cylinder's cross-sections. The same seed gives the same report everywhere.
KnotFuzzReport fuzzKnots(const KnotFuzzDef& def);

} // namespace filasofia::testing
