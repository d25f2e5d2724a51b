#include "verification/verification.h"

#include <numbers>

namespace patch_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A box with jittered inner nodes and a pinned surface.
Stage pinnedBox()
{
    const geometry::TetMesh mesh = boxMesh({4, 4, 4}, {0.4, 0.3, 0.2}, 0.25);
    SoftBodyDef def = freeBody(mesh);
    def.material = FemMaterial{.youngModulus = 1e4, .poissonRatio = 0.4};
    def.solver = Cholesky{};
    def.attachments = {{.nodes = nodesWhere(mesh, [](Vec3 p) {
                            return p.x == 0 || p.y == 0 || p.z == 0 || p.x == 0.4 || p.y == 0.3 || p.z == 0.2;
                        })}};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    return stage;
}

double worstDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, distance(a[i], b[i]));
    return worst;
}

} // namespace

TEST_CASE("patch test: if an affine map moves the surface, the inside follows the same map")
{
    std::mt19937 random(41);
    double still = 0.0, moving = 0.0;
    for (double size : {0.01, 0.1}) {
        Stage stage = pinnedBox();
        const Mat3 a = toMat3(randomRotation(random)) * (Mat3::identity() + randomMat3(random, size));
        std::vector<Vec3> expected, x = stage.model().rest;
        for (const Vec3& p : x) expected.push_back(a * p + Vec3{0.1, -0.2, 0.3});
        int inner = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] = expected[i];
            if (!stage.model().pins.hard[i]) x[i] += randomVec3(random, 0.005), ++inner;
        }
        REQUIRE(inner == 27);
        REQUIRE(worstDistance(x, expected) > 1e-3);

        // By Newton's method on the elements' forces ...
        std::vector<Vec3> solved = x;
        solveStatic(stage.model(), std::vector<Vec3>(x.size()), solved);
        still = std::max(still, worstDistance(solved, expected) / 0.4);
        // ... and by stepping the engine until all is at rest.
        stage.soft().x = x;
        stage.model().rayleigh = {.mass = 20.0, .stiffness = 0.0};
        stage.run(400, 0.1);
        moving = std::max(moving, worstDistance(stage.soft().x, expected) / 0.4);
    }
    verify("patch test, static, error over length", still, 1e-10);
    verify("patch test, stepped to rest, error over length", moving, 1e-10);
}

TEST_CASE("a rigid motion, however large, causes no force")
{
    for (const auto& [solver, name, bound] :
         {std::tuple{Solver{Cholesky{}}, "double", 1e-12}, std::tuple{Solver{ConjugateGradient{}}, "float", 5e-6}}) {
        std::mt19937 random(42);
        double worst = 0.0;
        for (double far : {0.0, 1.0, 100.0}) {
            Stage stage;
            stage.add(SoftBodyDef{.mesh = bunnyFile(756),
                                  .rayleigh = {0, 0},
                                  .gravity = false,
                                  .integrator = ExplicitEuler{},
                                  .solver = solver});
            stage.step(0.0);
            const Mat3 r = toMat3(axisAngle(randomVec3(random, 1.0), 0.9 * std::numbers::pi));
            for (Vec3& p : stage.soft().x) p = r * p + Vec3{far, -far, far};
            double area = 0.0;
            for (const geometry::Triangle& t : stage.model().surface) {
                const auto& rest = stage.model().rest;
                area += 0.5 * length(cross(rest[t[1]] - rest[t[0]], rest[t[2]] - rest[t[0]]));
            }
            double total = 0.0;
            for (const Vec3& f : forcesNow(stage)) total += length(f);
            // Double coordinates have a relative error of 1e-16, taken over an element's size of about 1 cm.
            worst = std::max(worst, total / (10e3 * area) / (1.0 + far / 0.01));
        }
        verify(text("forces of a rigid motion, sum of |f| over E A, ", name), worst, bound);
    }
}

} // namespace patch_test
