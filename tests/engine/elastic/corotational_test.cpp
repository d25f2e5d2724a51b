#include "filasofia/engine/elastic/corotational.h"

#include "filasofia/math/polar.h"

#include "engine/elastic/laws.h"
#include "engine/meshes.h"

namespace corotational_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

const Corners kRest{Vec3{0.1, 0, 0}, {1.2, 0.1, 0}, {0.2, 0.9, 0.1}, {0, 0.3, 1.1}};

FemElement someElement()
{
    return {.nodes = {0, 1, 2, 3},
            .gradients = shapeGradients(kRest),
            .volume = geometry::signedVolume(kRest[0], kRest[1], kRest[2], kRest[3]),
            .youngModulus = 3000,
            .poissonRatio = 0.4};
}

Corners mapped(const Mat3& a, Vec3 b)
{
    Corners x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = a * kRest[i] + b;
    return x;
}

} // namespace

TEST_CASE("shape gradients sum to zero, and each shape function rises from 0 to 1 at its own node")
{
    const Corners g = shapeGradients(kRest);
    CHECK(length(g[0] + g[1] + g[2] + g[3]) < 1e-14);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            if (i != j) CHECK(dot(g[i], kRest[i] - kRest[j]) == Approx(1.0).epsilon(1e-13));
}

TEST_CASE("the deformation gradient of an affine map is its matrix, wherever the element lies")
{
    std::mt19937 random(1);
    const Mat3 a = randomMat3(random, 2.0);
    CHECK(frobeniusNorm(gradient(someElement(), mapped(a, {1, 2, 3})) - a) < 1e-13);
    CHECK(frobeniusNorm(gradient(someElement(), mapped(a, {1e6, 0, 0})) - a) < 1e-8);
}

TEST_CASE("an element at rest has no forces, and its forces sum to zero in every deformation")
{
    std::mt19937 random(2);
    const FemElement element = someElement();
    for (const Vec3& f : forcesOf(physics::Corotational{}, element, kRest)) CHECK(length(f) < 1e-11);
    for (int k = 0; k < 50; ++k) {
        const Corners forces = forcesOf(physics::Corotational{}, element, mapped(randomMat3(random, 2.0), {}));
        CHECK(length(forces[0] + forces[1] + forces[2] + forces[3]) < 1e-11);
    }
}

TEST_CASE("small uniaxial strain gives the stress of Hooke's law")
{
    const auto [mu, lambda] = lame(3000, 0.4);
    const double strain = 1e-6;
    const Deformation at{Mat3::diagonal({1 + strain, 1, 1}), Mat3::identity()};
    const Mat3 stress = Mat3::diagonal({(lambda + 2 * mu) * strain, lambda * strain, lambda * strain});
    CHECK(frobeniusNorm(corotationalStress({mu, lambda}, at) - stress) < 1e-9 * frobeniusNorm(stress));
    CHECK(corotationalEnergy({mu, lambda}, at) == Approx(0.5 * (lambda + 2 * mu) * strain * strain).epsilon(1e-9));
}

TEST_CASE("the blocks of the warped stiffness give the same product as the change of the stress")
{
    std::mt19937 random(3);
    const FemElement element = someElement();
    for (int k = 0; k < 20; ++k) {
        const Mat3 r = toMat3(randomRotation(random));
        const WarpedTangent tangent{lame(3000, 0.4), r, k % 2 == 0 ? 0.0 : 5000.0};
        Corners x;
        for (Vec3& each : x) each = randomVec3(random, 1.0);
        const Corners whole = stiffnessTimes(tangent, element, x);
        for (int i = 0; i < 4; ++i) {
            Vec3 row;
            for (int j = 0; j < 4; ++j)
                row += element.volume *
                       stiffnessBlock(tangent, element.gradients[static_cast<std::size_t>(i)],
                                      element.gradients[static_cast<std::size_t>(j)]) *
                       x[static_cast<std::size_t>(j)];
            CHECK(length(row - whole[static_cast<std::size_t>(i)]) < 1e-10 * length(row));
        }
    }
}

TEST_CASE("the geometric stiffness of an element under uniform tension has a closed form")
{
    const Lame material = lame(3000, 0.45);
    const double ratio = material.lambda / material.mu;
    const Mat3 turned = toMat3(axisAngle({1, 2, 3}, 0.7));
    const auto stretched = [&](double s) { return geometricStiffness(material, {s * turned, turned}); };
    CHECK(stretched(1.0) == 0.0);
    CHECK(stretched(0.5) == 0.0);
    CHECK(stretched(1.0 + 0.99 * 2.0 / (3.0 * ratio)) == 0.0);
    CHECK(stretched(1.0 + 1.01 * 2.0 / (3.0 * ratio)) > 0.0);
    // In a nearly incompressible element a small growth causes large tension, but may come from rotation alone.
    const Mat3 grown = (1.0 + 0.3 * kTense) * turned;
    CHECK(geometricStiffness(lame(3000, 0.4999), {grown, turned}) == 0.0);
    CHECK(geometricStiffness(lame(3000, 0.4999), {(1.0 + 0.4 * kTense) * turned, turned}) > 0.0);
    // The three sums of two stretches are 2 s each; the least of them is estimated as (2 s)^3 / (3 s)^2.
    const double s = 1.3, q = ratio * 3.0 * (s - 1.0);
    CHECK(stretched(s) == Approx(material.mu * (1.0 + (q - 2.0) / (8.0 / 9.0 * s))).epsilon(1e-12));
    // If the element is a needle the stiffness would have no bound, so kFlattest limits the estimate.
    const Mat3 needle = Mat3::diagonal({10.0, 1e-6, 1e-6});
    CHECK(geometricStiffness(material, {needle, Mat3::identity()}) ==
          Approx(material.mu * (1.0 + (ratio * 7.0 - 2.0) / (10.0 * kFlattest))).epsilon(1e-5));
}

} // namespace corotational_test
