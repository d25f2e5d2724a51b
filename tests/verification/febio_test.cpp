#include "filasofia/geometry/shapes.h"
#include "skip.h"
#include "verification/febio/feb.h"
#include "verification/verification.h"

#include <cstdlib>

/// FEBio's public gold values: the root of the sum of the squares of all free nodal displacements
/// (febio/README.md).
namespace febio_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// Young's modulus and Poisson's ratio of these shear and bulk moduli [Pa].
FemMaterial tissueOf(double mu, double bulk, const ElasticLaw& law)
{
    return {.youngModulus = 9.0 * bulk * mu / (3.0 * bulk + mu),
            .poissonRatio = (3.0 * bulk - 2.0 * mu) / (2.0 * (3.0 * bulk + mu)),
            .law = law};
}

/// [m] The root of the sum of the squared displacements of nodes that are free.
double norm(const std::vector<Vec3>& x, const SoftModel& model)
{
    double sum = 0.0;
    for (std::size_t n = 0; n < x.size(); ++n)
        if (!model.pins.hard[n]) sum += lengthSquared(x[n] - model.rest[n]);
    return std::sqrt(sum);
}

/// The eight tetrahedra between three axes: te01 and its mirror images. Node 0 is the origin, 1 to 6 lie on the axes.
geometry::TetMesh octahedron()
{
    geometry::TetMesh mesh;
    mesh.nodes = {{}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int octant = 0; octant < 8; ++octant) {
        const int x = 1 + octant % 2, y = 3 + octant / 2 % 2, z = 5 + octant / 4;
        const bool mirrored = (octant % 2 + octant / 2 % 2 + octant / 4) % 2 == 1;
        mesh.tetrahedra.push_back(mirrored ? geometry::Tetrahedron{0, y, x, z} : geometry::Tetrahedron{0, x, y, z});
    }
    return mesh;
}

/// A tension [Pa] on the faces whose normal is the x axis. FEBio's cube is one hexahedron with a quarter of the force
/// at each node of a face; triangles get it by their areas.
std::vector<NodalForce> tensionAlongX(const SoftModel& model, double tension)
{
    std::vector<NodalForce> forces;
    for (const auto& [a, b, c] : model.surface) {
        const Vec3 area = 0.5 * cross(model.rest[b] - model.rest[a], model.rest[c] - model.rest[a]);
        if (std::abs(area.x) < 0.99 * length(area)) continue;
        for (const int node : {a, b, c}) forces.push_back({node, {tension / 3.0 * area.x, 0, 0}});
    }
    return forces;
}

/// A model of the test suite with nodes held at its sets, solved statically in ten parts of what acts on it.
struct GoldModel {
    FebMesh feb;
    Stage stage;

    GoldModel(const std::string& folder, const std::string& name, const FemMaterial& material)
        : feb(readFeb(folder + "/Verify/" + name + ".feb"))
    {
        SoftBodyDef def = freeBody(feb.mesh);
        def.material = material;
        AttachmentDef held;
        for (const auto& [set, nodes] : feb.sets)
            if (set.starts_with("Fixed")) held.nodes.insert(held.nodes.end(), nodes.begin(), nodes.end());
        def.attachments = {held};
        stage.add(def);
        stage.step(0.0);
    }
    /// `traction` [Pa] on its surfaces, `shift` [m] of the nodes whose displacement is prescribed.
    double solved(Vec3 traction, Vec3 shift)
    {
        const SoftModel& model = stage.model();
        std::vector<Vec3> x = model.rest;
        for (int part = 1; part <= 10; ++part) {
            std::vector<Vec3> loads(x.size());
            for (const auto& [a, b, c] : feb.loaded) {
                const double area =
                    0.5 * length(cross(x[b] - x[a], x[c] - x[a])); // FEBio's traction is on the present one
                for (const int node : {a, b, c}) loads[node] += area / 30.0 * part * traction;
            }
            for (const auto& [set, nodes] : feb.sets)
                if (set.starts_with("Prescribed"))
                    for (const int node : nodes) x[node] = model.rest[node] + 0.1 * part * shift;
            solveStatic(model, loads, x, part == 10 ? 1e-9 : 1e-6);
        }
        return norm(x, model);
    }
};

/// Empty, unless the environment says where a copy is.
std::string testSuite()
{
    const char* folder = std::getenv("FILASOFIA_FEBIO_TESTSUITE");
    return folder ? folder : "";
}

} // namespace

TEST_CASE("FEBio's te01: a tetrahedron that is pressed has FEBio's displacement")
{
    Stage stage;
    SoftBodyDef def = freeBody(octahedron());
    def.material = tissueOf(2.0, 1000.0, MooneyRivlin{.share = 0.0}); // c1 = 1, k = 1000
    def.attachments = {{.nodes = {0}}};
    def.mass = Density{1e-3}; // it may turn about this node: only its mass keeps it from that
    def.solver = Cholesky{};
    const BodyId body = stage.add(def);
    for (int step = 1; step <= 300; ++step) {
        const double force = -4 * 0.5 * std::min(1.0, step / 50.0); // four tetrahedra share a tip
        stage.post(SetForces{body, {{5, {0, 0, force}}, {6, {0, 0, -force}}}});
        stage.step(1.0);
    }
    const std::vector<Vec3>& x = stage.soft().x;
    double sum = 0.0;
    for (const int node : {1, 3, 5}) sum += lengthSquared(x[node] - stage.model().rest[node]);
    const double found = std::sqrt(sum);
    tell("FEBio's te01, sum of squared displacements, root", found);
    // FEBio's energy of volume is K/2 (ln J)^2, ours K/2 (J - 1)^2.
    verify("FEBio's te01 over its gold value 0.44268188785, less one", std::abs(found / 0.44268188785 - 1.0), 2e-6);
}

TEST_CASE("FEBio's ma05: a viscoelastic cube creeps to FEBio's displacement")
{
    // E = 1 Pa at the end and (1 + g1) E at once; eight cubes around the origin in place of symmetry planes.
    Stage stage;
    const auto cubes = geometry::shapes::block({2, 2, 2}, {2, 2, 2});
    SoftBodyDef def{.mesh = cubes};
    def.material =
        FemMaterial{.youngModulus = 1.95, .poissonRatio = 0.0, .relaxation = {{.share = 0.95 / 1.95, .time = 0.01}}};
    def.mass = Density{1e-3};
    def.rayleigh = {0.0, 0.0};
    def.gravity = false;
    def.solver = Cholesky{};
    const BodyId cube = stage.add(def);
    stage.step(0.0);
    stage.post(SetForces{cube, tensionAlongX(stage.model(), 2e-3)});
    stage.run(10, 0.01);
    double sum = 0.0;
    stage.run(200, 0.1);
    for (std::size_t n = 0; n < cubes->nodes.size(); ++n) {
        const Vec3 p = stage.model().rest[n];
        if (p.x > 0.0 && p.y >= 0.0 && p.z >= 0.0) sum += lengthSquared(stage.soft().x[n] - p);
    }
    tell("FEBio's ma05, sum of squared displacements, root", std::sqrt(sum));
    verify("FEBio's ma05 over its gold value 0.004003999996, less one", std::abs(std::sqrt(sum) / 0.004003999996 - 1.0),
           1e-9);
}

TEST_CASE("FEBio's te02, te03 and te05, nearly incompressible, on FEBio's meshes")
{
    const std::string folder = testSuite();
    if (skipIf(folder.empty(), "FILASOFIA_FEBIO_TESTSUITE does not say where FEBio's test suite is")) return;
    const auto compare = [&](const char* name, double gold, const FemMaterial& material, Vec3 traction, Vec3 shift) {
        GoldModel model(folder, name, material);
        const std::string what = text("FEBio's ", name, ", ", model.feb.mesh.tetrahedra.size(),
                                      " tetrahedra, displacement over that of FEBio");
        return std::pair{what, model.solved(traction, shift) / gold};
    };
    const auto [stretched, near] =
        compare("te03", 11.6851473735, {.youngModulus = 1.0, .poissonRatio = 0.49}, {}, {1, 0, 0});
    verifyWithin(stretched, near, 0.99, 1.01);
    // FEBio's nodally integrated elements bend more easily than linear ones in so coarse a mesh.
    const auto [bent, less] =
        compare("te02", 97.9737049748, {.youngModulus = 500.0, .poissonRatio = 0.49}, {0, 0, -1}, {});
    verifyWithin(bent, less, 0.7, 1.0);
    const auto [coarse, least] =
        compare("te05", 56.2269356852, tissueOf(334e3, 1.6667e8, MooneyRivlin{.share = 0.0}), {0, 0, -2000}, {});
    verifyWithin(coarse, least, 0.5, 1.0);
}

} // namespace febio_test
