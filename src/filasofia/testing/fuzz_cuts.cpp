#include "filasofia/testing/fuzz_cuts.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/text.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/fuzz_body.h"

#include <algorithm>
#include <cmath>

namespace filasofia::testing {
using namespace engine;
namespace {

constexpr int kKinds = static_cast<int>(FuzzKind::count_);

/// A ball: the lattice of a cube, mapped to a sphere (Nowell's map).
geometry::TetMesh ball(double radius, int cells)
{
    geometry::TetMesh mesh = *geometry::shapes::block({2, 2, 2}, {cells, cells, cells});
    for (Vec3& p : mesh.nodes) {
        const double x = p.x * p.x, y = p.y * p.y, z = p.z * p.z;
        p = radius * Vec3{p.x * std::sqrt(1 - y / 2 - z / 2 + y * z / 3),
                          p.y * std::sqrt(1 - z / 2 - x / 2 + z * x / 3),
                          p.z * std::sqrt(1 - x / 2 - y / 2 + x * y / 3)};
    }
    return mesh;
}

EditableMesh editable(const CutFuzzMesh& mesh)
{
    if (mesh.shell.triangles.empty()) return EditableMesh(mesh.mesh);
    return {mesh.shell.vertices, mesh.shell.triangles, 1e-3};
}

/// Moves the inner vertices of a sheet around z by up to a fifth of a cell, in the sheet.
geometry::TriangleMesh shaken(geometry::TriangleMesh sheet, double cell)
{
    FuzzRandom random(7);
    const auto [low, high] = geometry::boxAround(sheet.vertices);
    for (Vec3& p : sheet.vertices) {
        const Vec3 shift{random.uniform(-0.2, 0.2) * cell, 0.0, random.uniform(-0.2, 0.2) * cell};
        if (std::min({p.x - low.x, high.x - p.x, p.z - low.z, high.z - p.z}) > 0.5 * cell) p += shift;
    }
    return sheet;
}

/// Runs one body from its first cut to its last; returns its hash.
std::uint64_t runBody(const CutFuzzDef& def, int index, int cuts, CutFuzzReport& report, RuptureReport& sums)
{
    const CutFuzzMesh& mesh = def.meshes[index % def.meshes.size()];
    // Every body has its own random numbers: if one fails, it can be replayed without the bodies before it.
    Hasher seed;
    seed.add(def.seed);
    seed.add(static_cast<std::uint64_t>(index));
    FuzzRandom random(seed.value());
    FuzzBody body(editable(mesh), def, report, sums, text("body ", index, " (", mesh.name, ")"));
    for (int i = 0; i < cuts; ++i) {
        const auto kind = static_cast<FuzzKind>(random.below(kKinds));
        const std::optional<bool> bridged = fuzzCut(body, kind, random, i == 0);
        body.look();
        CutFuzzKind& counts = report.kinds[static_cast<int>(kind)];
        ++report.cuts;
        ++counts.cuts;
        counts.judged += bridged ? 1 : 0;
        counts.incomplete += bridged && *bridged ? 1 : 0;
        if (bridged && *bridged && report.examples.size() < 20)
            report.examples.push_back(
                text("body ", index, " (", mesh.name, "), cut ", i, ": ", name(kind), " incomplete"));
    }
    return hashOf(body.mesh.data());
}

void sumUp(const RuptureReport& sums, CutFuzzReport& report)
{
    for (int i = 0; i < kRuptureRefusals; ++i)
        report.refusals.push_back({name(static_cast<RuptureRefusal>(i)), sums.refused[i]});
    report.repairs = {{"crossings", sums.crossings},
                      {"snapped to nodes", sums.snapped},
                      {"snapped to keep quality", sums.snappedGuard},
                      {"nodes moved", sums.moves},
                      {"edges bisected", sums.bisections},
                      {"faces flagged", sums.flagged},
                      {"faces opened", sums.openedFaces},
                      {"nodes copied", sums.copies},
                      {"transactions", sums.edits},
                      {"transactions repaired", sums.repairedEdits},
                      {"rounds of repair", sums.repairRounds},
                      {"edges bisected in repair", sums.repairBisections},
                      {"cones flipped", sums.repairFlips},
                      {"slits opened in repair", sums.repairSlits},
                      {"faces put off", sums.repairDeferred},
                      {"flakes kept", sums.flakes},
                      {"transactions given up", sums.givenUp}};
    for (const CutFuzzKind& kind : report.kinds) {
        const bool full = kind.name == name(FuzzKind::Plane);
        (full ? report.full : report.progressive) += kind.judged;
        (full ? report.incompleteFull : report.incompleteProgressive) += kind.incomplete;
    }
}

} // namespace

std::vector<CutFuzzMesh> cutFuzzShapes()
{
    return {{"beam", *geometry::shapes::block({0.08, 0.02, 0.02}, {16, 4, 4})},
            {"ball", ball(0.03, 6)},
            {"sheet", *geometry::shapes::block({0.05, 0.05, 0.003}, {14, 14, 1})}};
}

std::vector<CutFuzzMesh> shellFuzzShapes()
{
    const geometry::TriangleMesh sheet = *geometry::shapes::sheet(0.06, 0.04, {18, 12});
    return {{"sheet", {}, sheet},
            {"irregular sheet", {}, shaken(sheet, 0.06 / 18)},
            {"balloon", {}, *geometry::shapes::sphere(0.03, 12)},
            {"cylinder", {}, *geometry::shapes::cylinder(0.01, 0.06, 6)}};
}

CutFuzzReport fuzzCuts(const CutFuzzDef& def)
{
    CutFuzzReport report;
    RuptureReport sums;
    Hasher all;
    for (int i = 0; i < kKinds; ++i) report.kinds.push_back({name(static_cast<FuzzKind>(i))});
    for (int index = 0; report.cuts < def.cuts; ++index) {
        const int cuts = std::min(def.cutsPerBody, def.cuts - static_cast<int>(report.cuts));
        const std::uint64_t hash = runBody(def, index, cuts, report, sums);
        all.add(hash);
        ++report.bodies;
        if (def.twice) {
            CutFuzzReport again{.kinds = report.kinds};
            RuptureReport sumsAgain;
            CutFuzzDef blind = def;
            blind.checkEvery = 1 << 30;
            if (runBody(blind, index, cuts, again, sumsAgain) != hash) ++report.hashesThatDiffer;
        }
        if (def.progress) def.progress(static_cast<int>(report.cuts));
    }
    sumUp(sums, report);
    report.hash = all.value();
    return report;
}

} // namespace filasofia::testing
