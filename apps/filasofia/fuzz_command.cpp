#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/fuzz_laws_output.h"
#include "apps/filasofia/json_file.h"
#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/testing/fuzz_contacts.h"
#include "filasofia/testing/fuzz_cuts.h"
#include "filasofia/testing/fuzz_knots.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <limits>

namespace filasofia::app {
namespace {

using nlohmann::json;

constexpr int kNotGiven = -1;

struct FuzzCommandOptions {
    std::string what;
    std::string file;
    int seed = 1;
    int cuts = kNotGiven;
    int perBody = kNotGiven;
    int scenes = kNotGiven;
    double seconds = std::numeric_limits<double>::quiet_NaN(); ///< [s] knots only; NaN if not given
    int first = kNotGiven;
    std::string law; ///< laws only; empty if not given
    bool fibres = false, tools = false, twice = false;
};

constexpr double kKnotSeconds = 60.0; ///< [s]
constexpr int kCuts = 2000, kPerBody = 4, kFuzzScenes = 200;

int given(int value, int standard) { return value == kNotGiven ? standard : value; }

constexpr int kExamples = 10; ///< number of example faults that are printed

json toJson(const std::vector<testing::CutFuzzCount>& counts)
{
    json all = json::object();
    for (const testing::CutFuzzCount& each : counts) all[each.name] = each.count;
    return all;
}

json toJson(const FuzzCommandOptions& options, const testing::CutFuzzReport& r)
{
    json kinds = json::array();
    for (const testing::CutFuzzKind& kind : r.kinds)
        kinds.push_back(
            {{"kind", kind.name}, {"cuts", kind.cuts}, {"judged", kind.judged}, {"incomplete", kind.incomplete}});
    return {{"fuzz", options.what},
            {"seed", options.seed},
            {"cuts", r.cuts},
            {"cuts_per_body", given(options.perBody, kPerBody)},
            {"bodies", r.bodies},
            {"steps", r.steps},
            {"edits", r.edits},
            {"checks", r.checks},
            {"kinds", kinds},
            {"broken_invariants", toJson(r.faults)},
            {"examples", r.examples},
            {"refusals", toJson(r.refusals)},
            {"repairs", toJson(r.repairs)},
            {"hashes_that_differ", r.hashesThatDiffer},
            {"worst_quality", r.worstQuality},
            {"worst_quality_over_bound", r.worstQualityShare},
            {"volume_drift", r.volumeDrift},
            {"most_tetrahedra", r.maxTetrahedra},
            {"full", {{"cuts", r.full}, {"incomplete", r.incompleteFull}}},
            {"progressive", {{"cuts", r.progressive}, {"incomplete", r.incompleteProgressive}}},
            {"hash", hexadecimal(r.hash)}};
}

void print(const testing::CutFuzzReport& r)
{
    std::printf("%ld cuts in %ld bodies: %ld steps, %ld edits, all invariants checked %ld times\n", r.cuts, r.bodies,
                r.steps, r.edits, r.checks);
    std::printf("\n%-16s %8s %8s %10s\n", "kind", "cuts", "judged", "incomplete");
    for (const testing::CutFuzzKind& kind : r.kinds)
        std::printf("%-16s %8ld %8ld %10ld\n", kind.name.c_str(), kind.cuts, kind.judged, kind.incomplete);
    const auto list = [](const char* title, const std::vector<testing::CutFuzzCount>& counts) {
        std::printf("\n%s:\n", title);
        for (const testing::CutFuzzCount& each : counts) std::printf("  %-28s %ld\n", each.name.c_str(), each.count);
    };
    list("refused", r.refusals);
    list("done and repaired", r.repairs);
    std::printf("\nworst quality %.4f, %.4f of the bound min(input, 0.15; in shells 0.25); volume kept to %.1e; at "
                "most %ld tetrahedra\n",
                r.worstQuality, r.worstQualityShare, r.volumeDrift, r.maxTetrahedra);
    std::printf("incomplete: %ld of %ld full cuts, %ld of %ld progressive ones\n", r.incompleteFull, r.full,
                r.incompleteProgressive, r.progressive);
    if (!r.faults.empty()) list("BROKEN INVARIANTS", r.faults);
    for (int i = 0; i < std::min<int>(kExamples, static_cast<int>(r.examples.size())); ++i)
        std::printf("  %s\n", r.examples[static_cast<std::size_t>(i)].c_str());
    std::printf("hash %s; %ld bodies differed when they were cut a second time\n", hexadecimal(r.hash).c_str(),
                r.hashesThatDiffer);
}

json toJson(const FuzzCommandOptions& options, const testing::KnotFuzzReport& r)
{
    json kinds = json::array();
    for (const testing::KnotFuzzKind& kind : r.kinds)
        kinds.push_back({{"kind", kind.name},
                         {"scenes", kind.scenes},
                         {"steps", kind.steps},
                         {"passes", kind.passes},
                         {"not_converged", kind.notConverged}});
    return {{"fuzz", options.what},
            {"seed", options.seed},
            {"first", given(options.first, 0)},
            {"tools", options.tools},
            {"seconds", r.seconds},
            {"scenes", r.scenes},
            {"steps", r.steps},
            {"kinds", kinds},
            {"passes", r.passes},
            {"loose_ends", r.looseEnds},
            {"linking_numbers", {{"tests", r.linkingTests}, {"changes", r.linkingChanges}}},
            {"nodes_inside_tissue", r.insideTissue},
            {"not_finite", r.notFinite},
            {"undone", r.undone},
            {"not_converged", r.notConverged},
            {"iterations", {{"median", r.median}, {"percentile_99", r.percentile99}, {"most", r.most}}},
            {"most_contacts", r.mostContacts},
            {"deepest_over_diameter", r.deepest},
            {"examples", r.examples},
            {"hashes_that_differ", r.hashesThatDiffer},
            {"hash", hexadecimal(r.hash)}};
}

void printHash(std::uint64_t hash, long differing, bool twice)
{
    std::printf("hash %s", hexadecimal(hash).c_str());
    if (twice) std::printf("; %ld scenes differed when they ran a second time", differing);
    std::printf("\n");
}

void print(const testing::KnotFuzzReport& r, bool twice)
{
    std::printf("%.1f simulated seconds in %ld scenes, %ld steps\n", r.seconds, r.scenes, r.steps);
    std::printf("\n%-16s %8s %8s %8s %14s\n", "kind", "scenes", "steps", "passes", "not converged");
    for (const testing::KnotFuzzKind& kind : r.kinds)
        std::printf("%-16s %8ld %8ld %8ld %14ld\n", kind.name.c_str(), kind.scenes, kind.steps, kind.passes,
                    kind.notConverged);
    std::printf("\npasses %ld; threads off their needles %ld; %ld of %ld linking numbers changed; nodes inside tissue "
                "%ld; not finite %ld, undone %ld\n",
                r.passes, r.looseEnds, r.linkingChanges, r.linkingTests, r.insideTissue, r.notFinite, r.undone);
    std::printf("iterations of a step: median %d, 99th percentile %d, most %d; not converged %ld\n", r.median,
                r.percentile99, r.most, r.notConverged);
    std::printf("at most %ld contacts; deepest overlap %.3f diameters\n", r.mostContacts, r.deepest);
    for (const std::string& example : r.examples) std::printf("  %s\n", example.c_str());
    printHash(r.hash, r.hashesThatDiffer, twice);
}

json toJson(const FuzzCommandOptions& options, const testing::ContactFuzzReport& r)
{
    json kinds = json::array();
    for (const testing::ContactFuzzKind& kind : r.kinds)
        kinds.push_back({{"kind", kind.name},
                         {"scenes", kind.scenes},
                         {"steps", kind.steps},
                         {"not_converged", kind.notConverged},
                         {"passes", kind.passes},
                         {"overlapping", kind.overlapping},
                         {"still_overlapping", kind.crowded},
                         {"inverted", kind.inverted},
                         {"restless", kind.restless}});
    return {{"fuzz", options.what},
            {"seed", options.seed},
            {"first", given(options.first, 0)},
            {"tools", options.tools},
            {"seconds", r.seconds},
            {"scenes", r.scenes},
            {"steps", r.steps},
            {"kinds", kinds},
            {"silent_overlaps", r.silentOverlaps},
            {"passes", r.passes},
            {"silent_inverted", r.silentInverted},
            {"energy", {{"gained", r.gained}, {"most", r.mostGained}}},
            {"not_finite", r.notFinite},
            {"undone", r.undone},
            {"deepest", r.deepest},
            {"iterations", {{"median", r.median}, {"percentile_99", r.percentile99}, {"most", r.most}}},
            {"examples", r.examples},
            {"hashes_that_differ", r.hashesThatDiffer},
            {"hash", hexadecimal(r.hash)}};
}

void print(const testing::ContactFuzzReport& r, bool twice)
{
    std::printf("%.1f simulated seconds in %ld scenes, %ld steps\n", r.seconds, r.scenes, r.steps);
    std::printf("\n%-14s %7s %9s %12s %10s %12s %9s %9s\n", "kind", "scenes", "steps", "overlapping", "to the end",
                "inside out", "restless", "capped");
    for (const testing::ContactFuzzKind& kind : r.kinds)
        std::printf("%-14s %7ld %9ld %12ld %10ld %12ld %9ld %9ld\n", kind.name.c_str(), kind.scenes, kind.steps,
                    kind.overlapping, kind.crowded, kind.inverted, kind.restless, kind.notConverged);
    std::printf("\nscenes whose bodies overlapped, and did so at the end; with elements inside out; with something "
                "faster than 1 mm/s at the end; steps at the iteration limit\n");
    std::printf("without a flag: overlaps %ld, elements inside out %ld; passes of threads %ld; not finite %ld, undone "
                "%ld\n",
                r.silentOverlaps, r.silentInverted, r.passes, r.notFinite, r.undone);
    std::printf("energy gained in %ld scenes, by %.2g %% at most; deepest overlap %.2f mm\n", r.gained,
                1e2 * r.mostGained, 1e3 * r.deepest);
    std::printf("iterations of a step: median %d, 99th percentile %d, most %d\n", r.median, r.percentile99, r.most);
    for (const std::string& example : r.examples) std::printf("  %s\n", example.c_str());
    printHash(r.hash, r.hashesThatDiffer, twice);
}

int fuzzContacts(const FuzzCommandOptions& options)
{
    JsonFile file(options.file);
    const testing::ContactFuzzReport report = testing::fuzzContacts({.seed = static_cast<std::uint64_t>(options.seed),
                                                                     .scenes = given(options.scenes, kFuzzScenes),
                                                                     .first = given(options.first, 0),
                                                                     .tools = options.tools,
                                                                     .twice = options.twice});
    print(report, options.twice);
    file.write(toJson(options, report));
    return report.sound() ? 0 : kFailed;
}

int fuzzLaws(const FuzzCommandOptions& options)
{
    JsonFile file(options.file);
    const testing::LawFuzzReport report = testing::fuzzLaws({.seed = static_cast<std::uint64_t>(options.seed),
                                                             .scenes = given(options.scenes, kFuzzScenes),
                                                             .first = given(options.first, 0),
                                                             .law = options.law,
                                                             .fibres = options.fibres});
    printLaws(report);
    json all = lawsToJson(report);
    all.update({{"fuzz", options.what},
                {"seed", options.seed},
                {"first", given(options.first, 0)},
                {"only", {{"law", options.law}, {"fibres", options.fibres}}}});
    file.write(all);
    return report.sound() ? 0 : kFailed;
}

int fuzzKnots(const FuzzCommandOptions& options)
{
    JsonFile file(options.file);
    const testing::KnotFuzzReport report =
        testing::fuzzKnots({.seed = static_cast<std::uint64_t>(options.seed),
                            .seconds = std::isnan(options.seconds) ? kKnotSeconds : options.seconds,
                            .first = given(options.first, 0),
                            .tools = options.tools,
                            .twice = options.twice});
    print(report, options.twice);
    file.write(toJson(options, report));
    return report.sound() ? 0 : kFailed;
}

int fuzzCuts(const FuzzCommandOptions& options)
{
    JsonFile file(options.file);
    const bool shells = options.what == "shells";
    testing::CutFuzzDef def{.seed = static_cast<std::uint64_t>(options.seed),
                            .cuts = given(options.cuts, kCuts),
                            .meshes = shells ? testing::shellFuzzShapes() : testing::cutFuzzShapes(),
                            .cutsPerBody = given(options.perBody, kPerBody)};
    for (const char* size : {"756", "1492"})
        if (!shells)
            def.meshes.push_back(
                {text("bunny ", size), geometry::loadTetMesh(runtime::asset(text("meshes/bunny_", size, ".msh")))});
    const testing::CutFuzzReport report = testing::fuzzCuts(def);
    print(report);
    file.write(toJson(options, report));
    return report.sound() ? 0 : kFailed;
}

int fuzz(const FuzzCommandOptions& options)
{
    const bool contact = options.what == "contact", knots = options.what == "knots", laws = options.what == "laws";
    const bool cuts = options.what == "cut" || options.what == "shells";
    if (!contact && !knots && !laws && !cuts)
        fail("fuzz: unknown subject '", shortened(options.what), "'; known are contact, cut, knots, laws and shells");
    const auto only = [](bool applies, bool isGiven, const char* option, const char* to) {
        if (isGiven && !applies) fail("fuzz: ", option, " applies to ", to, " only");
    };
    only(cuts, options.cuts != kNotGiven, "--cuts", "cut and shells");
    only(cuts, options.perBody != kNotGiven, "--per-body", "cut and shells");
    only(contact || laws, options.scenes != kNotGiven, "--scenes", "contact and laws");
    only(knots, !std::isnan(options.seconds), "--seconds", "knots");
    only(!cuts, options.first != kNotGiven, "--first", "contact, knots and laws");
    only(laws, !options.law.empty(), "--law", "laws");
    only(laws, options.fibres, "--fibres", "laws");
    only(contact || knots, options.tools, "--tools", "contact and knots");
    if (options.twice && cuts)
        fail("fuzz: --twice applies to contact and knots only; cut and shells cut each body twice");
    only(!laws, options.twice, "--twice", "contact and knots"); // laws replays each scene
    return knots ? fuzzKnots(options) : contact ? fuzzContacts(options) : laws ? fuzzLaws(options) : fuzzCuts(options);
}

} // namespace

Command fuzzCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static FuzzCommandOptions options;
    return {
        .name = "fuzz",
        .meaning = "Make random changes and check all invariants after each",
        .options =
            {{"WHAT",
              &options.what,
              "contact: bodies that fall, are pressed and squeezed; cut: cuts and tears of small bodies; shells: of "
              "shells; knots: threads that are tied and pulled; laws: small bodies of every law that are cut, torn, "
              "pulled and pressed",
              "",
              {},
              true},
             {.name = "--seed",
              .target = &options.seed,
              .meaning = "Seed of the random numbers",
              .type = "S",
              .bound = {closed(0, 1000000), "-"}},
             {.name = "--cuts",
              .target = &options.cuts,
              .meaning = "cut and shells only: number of cuts, including tears",
              .type = "N",
              .bound = {closed(1, 100000000), "-"},
              .standard = text(kCuts)},
             {.name = "--per-body",
              .target = &options.perBody,
              .meaning = "cut and shells only: cuts made one after another in the same body",
              .type = "N",
              .bound = {closed(1, 1000), "-"},
              .standard = text(kPerBody)},
             {.name = "--scenes",
              .target = &options.scenes,
              .meaning = "contact and laws only: number of scenes",
              .type = "N",
              .bound = {closed(1, 100000000), "-"},
              .standard = text(kFuzzScenes)},
             {.name = "--seconds",
              .target = &options.seconds,
              .meaning = "knots only: simulated time",
              .type = "S",
              .bound = {openClosed(0, 1000000), "s"},
              .standard = text(kKnotSeconds)},
             {.name = "--first",
              .target = &options.first,
              .meaning = "contact, knots and laws only: number of the first scene, to see one again",
              .type = "N",
              .bound = {closed(0, 100000000), "-"},
              .standard = "0"},
             {.name = "--law",
              .target = &options.law,
              .meaning = "laws only: leave out scenes of other laws, or all but those of shells",
              .type = "NAME",
              .choices = testing::lawFuzzKinds()},
             {"--fibres", &options.fibres, "laws only: leave out scenes whose tissue begins without fibres"},
             {"--tools", &options.tools,
              "contact and knots only: scenes of blades, threads and needles, or of needles, jaws and soft cylinders"},
             {"--twice", &options.twice, "contact and knots only: run every scene a second time and compare"},
             {"--json", &options.file, "Write every figure to this file", "FILE"}},
        .run = [] { return fuzz(options); }};
}

} // namespace filasofia::app
