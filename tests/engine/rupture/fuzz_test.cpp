#include "filasofia/testing/fuzz_cuts.h"

#include "effort.h"
#include "filasofia/geometry/mesh_file.h"

namespace fuzz_test {

using namespace filasofia;
using namespace filasofia::testing;

namespace {

testing::CutFuzzDef fuzzOf(int cuts, std::uint64_t seed)
{
    testing::CutFuzzDef def{.seed = seed, .cuts = cuts, .meshes = testing::cutFuzzShapes()};
    for (const char* name : {"bunny_756", "bunny_1492"})
        def.meshes.push_back(
            {name, geometry::loadTetMesh(std::string(FILASOFIA_SOURCE_DIR "/assets/meshes/") + name + ".msh")});
    return def;
}

} // namespace

TEST_CASE("random cuts and tears keep meshes valid, leave hardly any bridge, and repeat bit-identically", "[cases]")
{
    const testing::CutFuzzReport report = testing::fuzzCuts(fuzzOf(cases(2000), 1));
    CHECK(report.cuts == cases(2000));
    for (const testing::CutFuzzCount& fault : report.faults) FAIL_CHECK(fault.name << ": " << fault.count);
    for (const std::string& example : report.examples) WARN(example);
    CHECK(report.hashesThatDiffer == 0);
    CHECK(report.worstQualityShare >= 1.0 - 1e-9);
    CHECK(report.volumeDrift < 1e-3);
    CHECK(report.full > cases(150));
    CHECK(report.progressive > cases(500));
    CHECK(report.incompleteFull <= 0.001 * report.full);
    CHECK(report.incompleteProgressive <= 0.003 * report.progressive);
    for (const testing::CutFuzzKind& kind : report.kinds) CHECK(kind.cuts > cases(150));
}

TEST_CASE("a body that is cut twenty times stays valid")
{
    testing::CutFuzzDef def = fuzzOf(100, 2);
    def.cutsPerBody = 20;
    def.twice = false;
    const testing::CutFuzzReport report = testing::fuzzCuts(def);
    CHECK(report.sound());
    CHECK(report.bodies == 5);
    CHECK(report.worstQualityShare >= 1.0 - 1e-9);
}

} // namespace fuzz_test
