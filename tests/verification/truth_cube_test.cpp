#include "filasofia/engine/body/elements.h"

#include "engine/elastic/laws.h"
#include "engine/volumes.h"
#include "skip.h"
#include "verification/verification.h"

#include <cstdlib>
#include <fstream>

/// The Truth Cube: 343 beads in a cube of silicone, 80 mm wide, whose positions were measured at four compressions
/// (Kerdok et al. 2003, Medical Image Analysis 7, 283-291). Our tissue is given the outer beads and says where the
/// inner ones are: that needs neither Young's modulus nor what held the cube.
namespace truth_cube_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr int kBeads = 7, kRefined = 1; // along an edge; cells between two beads
constexpr int kCells = kRefined * (kBeads - 1);
using Beads = std::array<std::vector<Vec3>, 4>; ///< [m] per compression, in the order of boxMesh

/// From the table uniaxial_positions.csv: seven lines of titles, then i, j, k and four positions in mm. Its z axis
/// points against k.
Beads readBeads(const std::string& file)
{
    std::ifstream in(file);
    Beads beads;
    std::string line;
    for (int n = 0; std::getline(in, line); ++n) {
        if (n < 7) continue;
        std::ranges::replace(line, ',', ' ');
        std::istringstream numbers(line);
        int i = 0, j = 0, k = 0;
        numbers >> i >> j >> k;
        for (std::vector<Vec3>& state : beads) {
            Vec3 p;
            if (numbers >> p.x >> p.y >> p.z) state.push_back(1e-3 * Vec3{p.x, p.y, -p.z});
        }
    }
    for (const std::vector<Vec3>& state : beads) REQUIRE(state.size() == std::size_t{kBeads * kBeads * kBeads});
    return beads;
}

/// The point at these parts of the lattice of beads [-], in units of beads, interpolated linearly along each axis.
Vec3 within(const std::vector<Vec3>& beads, Vec3 at)
{
    std::array<int, 3> low{};
    for (int d = 0; d < 3; ++d) low[d] = std::min(static_cast<int>(at[d]), kBeads - 2);
    Vec3 sum;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        int place = 0;
        for (int d = 0; d < 3; ++d) {
            const int up = corner >> d & 1;
            weight *= up ? at[d] - low[d] : 1.0 - (at[d] - low[d]);
            place = kBeads * place + low[d] + up;
        }
        sum += weight * beads[static_cast<std::size_t>(place)];
    }
    return sum;
}

bool outer(Vec3 at)
{
    for (int d = 0; d < 3; ++d)
        if (std::min(at[d], kBeads - 1 - at[d]) < 1e-9) return true;
    return false;
}

/// [m] Root mean squares over the inner beads.
struct Compared {
    double moved = 0.0; ///< how far they moved
    double error = 0.0; ///< from where they were found
};

Compared compare(const Beads& beads, std::size_t compression, double nu)
{
    const geometry::TetMesh lattice = boxMesh({kCells, kCells, kCells}, Vec3{1, 1, 1} * (kBeads - 1.0));
    geometry::TetMesh mesh = lattice;
    for (Vec3& p : mesh.nodes) p = within(beads[0], p);
    SoftBodyDef def = freeBody(mesh);
    def.material = FemMaterial{.youngModulus = 15e3, .poissonRatio = nu};
    def.solver = Cholesky{};
    def.attachments = {{.nodes = nodesWhere(lattice, outer)}};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    std::vector<Vec3> x;
    for (const Vec3& p : lattice.nodes) x.push_back(within(beads[compression], p)); // inner beads are a guess only
    solveStatic(stage.model(), std::vector<Vec3>(x.size()), x, 1e-6);
    Compared out;
    double count = 0.0;
    for (std::size_t n = 0; n < x.size(); ++n) {
        const Vec3 at = lattice.nodes[n];
        const bool bead = std::ranges::all_of(std::array{at.x, at.y, at.z},
                                              [](double a) { return std::abs(a - std::round(a)) < 1e-9; });
        if (!bead || outer(at)) continue;
        const Vec3 found = within(beads[compression], at);
        out.moved += lengthSquared(found - within(beads[0], at));
        out.error += lengthSquared(found - x[n]);
        count += 1.0;
    }
    return {std::sqrt(out.moved / count), std::sqrt(out.error / count)};
}

} // namespace

TEST_CASE("Truth Cube: its inner beads are where tissue with its outer beads has them")
{
    const char* file = std::getenv("FILASOFIA_TRUTH_CUBE");
    if (skipIf(!file, "FILASOFIA_TRUTH_CUBE does not say where its table of beads is")) return;
    const Beads beads = readBeads(file);
    const std::array<double, 4> nominal{0.0, 5.0, 12.5, 18.25}; // [%]
    for (std::size_t k = 1; k < beads.size(); ++k) {
        const Compared at = compare(beads, k, 0.499);
        const std::string what = text("Truth Cube at ", nominal[k], " %, 125 inner beads, ");
        tell(what + "root mean square of what they moved [m]", at.moved);
        verify(what + "of the distance from where tissue has them [m]", at.error, 0.6e-3);
        tell(what + "the same with a Poisson's ratio of 0", compare(beads, k, 0.0).error);
    }
}

TEST_CASE("Truth Cube: glued between plates, tissue of its silicone is stiffer than what was measured by indentation")
{
    constexpr double kWidth = 0.08, kYoung = 15.3e3, kNu = 0.499, kShort = 1e-3; // [m] [Pa] [-] [m]
    std::vector<double> slopes;
    for (const int n : {4, 8}) {
        const geometry::TetMesh mesh = boxMesh({n, n, n}, {kWidth, kWidth, kWidth});
        SoftBodyDef def = freeBody(mesh);
        def.material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu};
        def.solver = Cholesky{};
        def.attachments = {{.nodes = nodesWhere(mesh, [&](Vec3 p) { return std::min(p.z, kWidth - p.z) < 1e-9; })}};
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        const SoftModel& model = stage.model();
        std::vector<Vec3> x = model.rest;
        for (Vec3& p : x) p.z *= 1.0 - kShort / kWidth;
        solveStatic(model, std::vector<Vec3>(x.size()), x, 1e-6);
        // The work of the first millimetre is half of force times way.
        double energy = nodalEnergy(model, x);
        for (const FemElement& e : model.elements) energy += energyOf(NeoHookean{}, e, cornersOf(e.nodes, x));
        slopes.push_back(2.0 * energy / (kShort * kShort));
        tell(text("Truth Cube, glued, ", n, " cells along an edge, slope over E times its width"),
             slopes.back() / (kYoung * kWidth));
    }
    const double slope = slopes[1] + (slopes[1] - slopes[0]) / 3.0;
    verifyWithin("Truth Cube, glued, extrapolated, slope over E times its width", slope / (kYoung * kWidth), 1.15, 1.4);
    tell("Truth Cube, glued, slope over 798 N/m", slope / 798.0);
}

} // namespace truth_cube_test
