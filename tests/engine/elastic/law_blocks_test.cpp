#include "filasofia/engine/elastic/stress_bound.h"
#include "filasofia/math/svd.h"

#include "engine/elastic/element_blocks.h"

namespace law_blocks_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Deformations as simulations have them: turned, strained, flattened, inside out.
void deform(std::mt19937& random, Elements& all)
{
    for (int e = 0; e < all.count(); ++e) {
        const Mat3 turn = toMat3(randomRotation(random)), any = randomMat3(random, 1.0);
        switch (e % 6) {
        case 5:
            all.deform(e, turn * (Mat3::identity() + std::pow(10.0, -2.0 - e % 7) * any));
            break; // hardly strained
        case 0:
            all.deform(e, turn, randomVec3(random, 1.0));
            break;
        case 1:
            all.deform(e, turn * (Mat3::identity() + 0.05 * any), randomVec3(random, 1.0));
            break;
        case 2:
            all.deform(e, turn * (Mat3::identity() + 0.4 * any), randomVec3(random, 1.0));
            break;
        case 3:
            all.deform(e, turn * Mat3::diagonal({1.2, 1.0, 0.1}), randomVec3(random, 1.0));
            break;
        default:
            all.deform(e, turn * Mat3::diagonal({1.1, 0.9, -0.3}));
            break;
        }
    }
}

/// The largest entry of a tangent [Pa].
double sizeOf(const ElementTangent& tangent)
{
    double most = 0.0;
    for (int k = 0; k < 9; ++k) {
        Mat3 unit;
        unit[k / 3][k % 3] = 1.0;
        most = std::max(most, frobeniusNorm(stressChange(tangent, unit)));
    }
    return most;
}

} // namespace

TEST_CASE("every law: blocks of elements match the double-precision element on every instruction set")
{
    for (const auto& named : everyLaw())
        onEveryTarget([&](const std::string&) {
            INFO(named.name);
            std::mt19937 random(1);
            Elements all(randomElements(random, 16 * 20 - 5, 0.45), named.law);
            deform(random, all);
            randomMotion(random, all);
            all.run();
            double forces = 0.0, products = 0.0;
            for (int e = 0; e < all.count(); ++e) {
                const FemElement& element = all.elements[static_cast<std::size_t>(e)];
                const Deformation at{gradient(element, Elements::nodes(all.x, e)), toMat3(normalized(all.rotation(e)))};
                const Lame material = lameOf(element);
                const ElementTangent tangent =
                    tangentAt(named.law, material, at, static_cast<double>(kWeights.turning));
                const Corners force = internalForces(element, stressAt(named.law, material, at));
                const Corners kv = stiffnessTimes(tangent, element, Elements::nodes(all.v, e));
                const Corners kp = stiffnessTimes(tangent, element, Elements::nodes(all.p, e));
                double steepest = 0.0, rate = 0.0, direction = 0.0;
                for (std::size_t i = 0; i < 4; ++i) {
                    steepest = std::max(steepest, length(element.gradients[i]));
                    rate = std::max(rate, length(Elements::nodes(all.v, e)[i]));
                    direction = std::max(direction, length(Elements::nodes(all.p, e)[i]));
                }
                const double stiff = element.volume * steepest * sizeOf(tangent);
                for (int i = 0; i < 4; ++i)
                    for (int c = 0; c < 3; ++c) {
                        const auto corner = static_cast<std::size_t>(i);
                        const double f = -kWeights.force * force[corner][c] - kWeights.stiffness * kv[corner][c];
                        const double size = kWeights.force * (stiff * frobeniusNorm(at.f) + length(force[corner])) +
                                            kWeights.stiffness * stiff * steepest * rate;
                        const double product = kWeights.stiffness * kp[corner][c];
                        forces = std::max(forces, std::abs(Elements::corner(all.corners, e, i)[c] - f) / size);
                        products = std::max(products, std::abs(Elements::corner(all.products, e, i)[c] - product) /
                                                          (kWeights.stiffness * stiff * steepest * direction));
                    }
            }
            CHECK(forces < 1e-4);
            CHECK(products < 2e-3); // where two stretches are nearly equal, a quotient of differences is replaced
        });
}

TEST_CASE("strains beyond a limit match the singular values, and others stay below it")
{
    constexpr float limit = 0.15f;
    onEveryTarget([&](const std::string&) {
        std::mt19937 random(2);
        Elements all(randomElements(random, 16 * 20 - 5, 0.45), physics::NeoHookean{});
        deform(random, all);
        for (int pass = 0; pass < 8; ++pass) // until the rotations are those of the polar decomposition
            updateElements(all.law, all.elementBlocks,
                           {.x = all.x, .v = all.v, .weights = kWeights, .validStrain = limit}, {0, all.blocks},
                           all.output());
        int beyond = 0, below = 0;
        for (int e = 0; e < all.count(); ++e) {
            const auto at = static_cast<std::size_t>(e);
            const Mat3 f = gradient(all.elements[at], Elements::nodes(all.x, e));
            if (!(determinant(f) > 1e-3)) continue; // the rotation of a flat element is not unique
            const Vec3 sigma = svd(f).sigma;
            const double strain = std::max({std::abs(sigma.x - 1), std::abs(sigma.y - 1), std::abs(sigma.z - 1)});
            const auto found = static_cast<double>(all.strains[at]);
            if (strain > limit + 1e-4) {
                CHECK(std::abs(found - strain) < 1e-4 * (1.0 + strain));
                ++beyond;
            } else if (strain < limit - 1e-4) {
                CHECK(found < limit);
                ++below;
            }
        }
        CHECK(beyond > 50);
        CHECK(below > 50);
    });
}

TEST_CASE("every law: instruction sets with fused multiply-add give the same bits")
{
    for (const auto& named : everyLaw())
        linalg::checkSameBitsWhereFused([&] {
            std::mt19937 random(2);
            Elements all(randomElements(random, 16 * 10, 0.45), named.law);
            deform(random, all);
            randomMotion(random, all);
            all.run();
            return std::vector<std::uint64_t>{hashOf(all.corners), hashOf(all.products), hashOf(all.quaternions)};
        });
}

TEST_CASE("every law: a position that is not finite affects only its own element")
{
    for (const auto& named : everyLaw())
        onEveryTarget([&](const std::string&) {
            std::mt19937 random(5);
            Elements all(randomElements(random, 16 * 3, 0.4), named.law);
            deform(random, all);
            randomMotion(random, all);
            Elements spoiled = all;
            const int lane = 21;
            spoiled.x[4 * lane + 2][1] = std::numeric_limits<float>::quiet_NaN();
            all.run();
            spoiled.run();
            for (int e = 0; e < all.count(); ++e) {
                bool same = true;
                for (int i = 0; i < 4; ++i)
                    for (const auto& array : {&Elements::corners, &Elements::products})
                        same = same && std::memcmp(Elements::corner(spoiled.*array, e, i),
                                                   Elements::corner(all.*array, e, i), 16) == 0;
                CHECK(same == (e != lane));
            }
        });
}

TEST_CASE("every law: lanes behind the last element contribute nothing")
{
    for (const auto& named : everyLaw())
        onEveryTarget([&](const std::string&) {
            std::mt19937 random(3);
            Elements all(randomElements(random, 20, 0.4), named.law);
            deform(random, all);
            randomMotion(random, all);
            all.run();
            for (int lane = 20; lane < 32; ++lane)
                for (int i = 0; i < 4; ++i)
                    for (const NodeArray* array : {&all.corners, &all.products})
                        CHECK(vectorOf(Elements::corner(*array, lane, i)) == Vec3{});
        });
}

TEST_CASE("every law: an element that is not marked as stressed has no principal stress at the limit")
{
    for (const auto& named : everyLaw())
        onEveryTarget([&](const std::string&) {
            INFO(named.name);
            std::mt19937 random(4);
            Elements all(randomElements(random, 16 * 40, 0.4), named.law);
            float mu = 0.0f, lambda = 0.0f;
            for (int e = 0; e < all.count(); ++e) {
                const Mat3 f = Mat3::identity() + (0.02 * (e % 20)) * randomMat3(random, 1.0);
                all.deform(e, toMat3(randomRotation(random)) * f, randomVec3(random, 10.0));
                const Lame material = lameOf(all.elements[static_cast<std::size_t>(e)]);
                mu = std::max(mu, static_cast<float>(material.mu));
                lambda = std::max(lambda, static_cast<float>(material.lambda));
            }
            all.run();
            const float limit = 0.5f * mu;
            std::vector<std::uint16_t> stressed(static_cast<std::size_t>(all.blocks));
            findStressed({all.elementBlocks, all.x, all.rotations}, {all.law, limit, mu, lambda}, stressed,
                         {0, all.blocks});
            int marked = 0, above = 0;
            for (int e = 0; e < all.count(); ++e) {
                const FemElement& element = all.elements[static_cast<std::size_t>(e)];
                const Mat3 f = gradient(element, Elements::nodes(all.x, e));
                const Mat3 sigma = cauchyStress(named.law, lameOf(element), deformation(f));
                const bool isMarked =
                    (stressed[static_cast<std::size_t>(e / kBlock)] >> static_cast<unsigned>(e % kBlock) & 1u) != 0;
                const Vec3 principal = svd(sigma + Mat3::diagonal({1e3, 1e3, 1e3})).sigma;
                const bool isAbove = principal.x - 1e3 >= static_cast<double>(limit);
                if (isAbove) CHECK(isMarked);
                marked += isMarked ? 1 : 0;
                above += isAbove ? 1 : 0;
            }
            CHECK(above > 20);
            CHECK(marked < all.count());
        });
}

} // namespace law_blocks_test
