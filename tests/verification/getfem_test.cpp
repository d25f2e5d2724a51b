#include "verification/calculix/deck.h"
#include "verification/verification.h"

/// Nearly incompressible tissue, whose nodes share their volumes, against GetFEM on the same mesh.
namespace getfem_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

const std::string kFolder = FILASOFIA_SOURCE_DIR "/tests/verification/";
constexpr double kShear = 1e4; ///< [Pa]
constexpr int kLoadSteps = 10;

/// [m] Displacements of the block of CalculiX's decks at rest under its loads.
std::vector<Vec3> restOf(double nu, const ElasticLaw& law = NeoHookean{})
{
    Deck deck = readDeck(kFolder + "calculix/neo_hooke_block.inp");
    deck.def.material = FemMaterial{.youngModulus = 2.0 * kShear * (1.0 + nu), .poissonRatio = nu, .law = law};
    const std::vector<NodalForce> forces = std::exchange(deck.def.forces, {});
    Stage stage;
    stage.add(deck.def);
    stage.step(0.0);
    const SoftModel& model = stage.model();
    std::vector<Vec3> x = model.rest;
    for (int i = 1; i <= kLoadSteps; ++i) {
        std::vector<Vec3> loads(x.size());
        for (const NodalForce& each : forces)
            loads[static_cast<std::size_t>(each.node)] += static_cast<double>(i) / kLoadSteps * each.force;
        solveStatic(model, loads, x, i == kLoadSteps ? 1e-9 : 1e-4);
    }
    for (std::size_t n = 0; n < x.size(); ++n) x[n] -= model.rest[n];
    return x;
}

double largestOf(const std::vector<Vec3>& vectors)
{
    double most = 0.0;
    for (const Vec3& each : vectors) most = std::max(most, length(each));
    return most;
}

double gapOf(std::vector<Vec3> a, const std::vector<Vec3>& b)
{
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
    return largestOf(a) / largestOf(b);
}

} // namespace

TEST_CASE("a block is pulled and bent far as in GetFEM, up to a Poisson's ratio of 0.4999")
{
    for (const double nu : {0.45, 0.49, 0.499, 0.4999}) {
        const std::vector<Vec3> found = restOf(nu);
        const std::vector<Vec3> expected = readDisplacements(text(kFolder, "getfem/linear_", nu, ".csv"));
        tell(text("block of nu ", nu, ", GetFEM's largest displacement [m]"), largestOf(expected));
        verify(text("block of nu ", nu, " against GetFEM, largest difference over largest displacement"),
               gapOf(found, expected), 1e-5);
    }
}

TEST_CASE("a block of Gent's law is pulled and bent as in GetFEM, up to nine tenths of its limit")
{
    for (const double limit : {0.1, 2.0}) {
        const std::vector<Vec3> found = restOf(0.4, Gent{.limit = limit});
        const std::vector<Vec3> expected = readDisplacements(text(kFolder, "getfem/gent_", limit, ".csv"));
        tell(text("block of Gent's law, limit ", limit, ", GetFEM's largest displacement [m]"), largestOf(expected));
        verify(
            text("block of Gent's law, limit ", limit, " against GetFEM, largest difference over largest displacement"),
            gapOf(found, expected), 1e-5);
    }
}

TEST_CASE("what a coarse mesh of linear tetrahedra lacks at a Poisson's ratio of 0.4999, against quadratic ones")
{
    const std::vector<Vec3> exact = readDisplacements(kFolder + "getfem/taylor_hood_0.4999.csv");
    // Four linear tetrahedra through the height bend too little whatever their Poisson's ratio.
    verifyWithin(
        "block of nu 0.4999, largest displacement over that of Taylor's and Hood's tetrahedra in the same mesh",
        largestOf(restOf(0.4999)) / largestOf(exact), 0.75, 1.0);
}

} // namespace getfem_test
