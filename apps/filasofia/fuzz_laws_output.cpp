#include "apps/filasofia/fuzz_laws_output.h"

#include "filasofia/core/hash.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace filasofia::app {

using nlohmann::json;

json lawsToJson(const testing::LawFuzzReport& r)
{
    json kinds = json::array();
    for (const testing::LawFuzzKind& kind : r.kinds)
        kinds.push_back({{"law", kind.name},
                         {"scenes", kind.scenes},
                         {"steps", kind.steps},
                         {"strokes", kind.strokes},
                         {"cuts", kind.cuts},
                         {"tears", kind.tears},
                         {"inverted", kind.inverted},
                         {"inverted_at_the_end", kind.stillInverted},
                         {"gained", kind.gained},
                         {"undone", kind.undone},
                         {"not_converged", kind.notConverged},
                         {"cut_short", kind.cutShort}});
    return {{"seconds", r.seconds},
            {"scenes", r.scenes},
            {"steps", r.steps},
            {"kinds", kinds},
            {"tissue",
             {{"fibres", r.fibres},
              {"relaxing", r.relaxing},
              {"flowing", r.flowing},
              {"regions", r.regions},
              {"nearly_incompressible", r.nearlyIncompressible}}},
            {"acts", {{"presses", r.presses}, {"grasps", r.grasps}, {"pulls", r.pulls}, {"changes", r.changes}}},
            {"silent_inverted", r.silentInverted},
            {"silent_strain", r.silentStrain},
            {"silent_gain", {{"scenes", r.silentGain}, {"most", r.mostSilent}}},
            {"mass_changed", r.massChanged},
            {"not_finite", r.notFinite},
            {"replays", r.replays},
            {"hashes_that_differ", r.hashesThatDiffer},
            {"iterations", {{"median", r.median}, {"percentile_99", r.percentile99}, {"most", r.most}}},
            {"examples", r.examples},
            {"hash", hexadecimal(r.hash)}};
}

void printLaws(const testing::LawFuzzReport& r)
{
    std::printf("%.1f simulated seconds in %ld scenes, %ld steps\n", r.seconds, r.scenes, r.steps);
    std::printf("\n%-18s %7s %9s %8s %8s %8s %11s %7s %7s %7s %7s %6s\n", "law", "scenes", "steps", "strokes", "cuts",
                "tears", "inside out", "at end", "gained", "undone", "capped", "short");
    for (const testing::LawFuzzKind& kind : r.kinds)
        std::printf("%-18s %7ld %9ld %8ld %8ld %8ld %11ld %7ld %7ld %7ld %7ld %6ld\n", kind.name.c_str(), kind.scenes,
                    kind.steps, kind.strokes, kind.cuts, kind.tears, kind.inverted, kind.stillInverted, kind.gained,
                    kind.undone, kind.notConverged, kind.cutShort);
    std::printf(
        "\nblades led through tissue; steps in which they opened it, and in which it tore; scenes with elements "
        "inside out, and at the end; scenes that gained energy, and with a state that was restored; steps at the "
        "iteration limit\n");
    std::printf("tissue with fibres %ld, that relaxes %ld, that flows %ld, with regions %ld, nu above 0.45 %ld\n",
                r.fibres, r.relaxing, r.flowing, r.regions, r.nearlyIncompressible);
    std::printf("presses %ld, grasps %ld, pulls %ld, changes of tissue %ld\n", r.presses, r.grasps, r.pulls, r.changes);
    std::printf("without a flag: elements inside out %ld, strained %ld; not finite %ld; masses that changed %ld\n",
                r.silentInverted, r.silentStrain, r.notFinite, r.massChanged);
    std::printf("energy gained without a flag before: %ld scenes; at most %.2g %% without a flag\n", r.silentGain,
                1e2 * r.mostSilent);
    std::printf("iterations of a step: median %d, 99th percentile %d, most %d\n", r.median, r.percentile99, r.most);
    for (const std::string& example : r.examples) std::printf("  %s\n", example.c_str());
    std::printf("hash %s; %ld of %ld replays with 2 or 8 threads differed\n", hexadecimal(r.hash).c_str(),
                r.hashesThatDiffer, r.replays);
}

} // namespace filasofia::app
