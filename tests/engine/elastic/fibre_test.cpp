#include "filasofia/engine/elastic/fibre.h"

#include "engine/elastic/element_blocks.h"

namespace fibre_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::FibreFamily;

namespace {

const std::array<FibreFamily, 4> kFamilies{
    {{.stiffness = 2.0, .exponent = 1.5},
     {.stiffness = 0.7, .exponent = 20.0, .dispersion = 0.2},
     {.stiffness = 0.0, .activeStress = 1.3},
     {.stiffness = 3.0, .exponent = 0.5, .dispersion = 0.1, .activeStress = 0.4}}};

Vec3 randomDirection(std::mt19937& random)
{
    const Vec3 d = randomVec3(random, 1.0);
    return 1.0 / length(d) * d;
}

} // namespace

TEST_CASE("fibres: the stress is the derivative of the energy, the tangent that of the stress")
{
    std::mt19937 random(1);
    constexpr double kStep = 1e-6;
    for (const FibreFamily& family : kFamilies)
        for (int trial = 0; trial < 200; ++trial) {
            const Vec3 a = randomDirection(random);
            const Mat3 f = Mat3::identity() + 0.4 * randomMat3(random, 1.0), df = randomMat3(random, 1.0);
            const auto energy = [&](double t) { return fibreEnergy(family, a, f + t * df); };
            const auto stress = [&](double t) { return fibreStress(family, a, f + t * df); };
            const double slope = (energy(kStep) - energy(-kStep)) / (2.0 * kStep);
            const double size = 1.0 + frobeniusNorm(stress(0.0));
            CHECK_THAT(contract(stress(0.0), df), Catch::Matchers::WithinAbs(slope, 1e-7 * size));
            const Mat3 change = 1.0 / (2.0 * kStep) * (stress(kStep) - stress(-kStep));
            const Mat3 tangent = stressChange(fibreTangent(family, a, f, 1.0), df);
            CHECK(frobeniusNorm(change - tangent) < 2e-5 * (1.0 + frobeniusNorm(tangent)));
        }
}

TEST_CASE("fibres: slack fibres bear nothing, and a zero direction is no fibre")
{
    const FibreFamily family{.stiffness = 5.0, .exponent = 2.0};
    CHECK(fibreStress(family, {1, 0, 0}, Mat3::diagonal({0.9, 1.3, 1.3})) == Mat3{});
    CHECK(fibreTangent(family, {1, 0, 0}, Mat3::diagonal({0.9, 1.3, 1.3}), 1.0).stiffness == 0.0);
    CHECK(fibreStress({.activeStress = 2.0}, {}, Mat3::diagonal({1.5, 1, 1})) == Mat3{});
    // The active stress is T F H, also in slack fibres.
    const Mat3 active = fibreStress({.stiffness = 0.0, .activeStress = 2.0}, {1, 0, 0}, Mat3::diagonal({0.8, 1, 1}));
    CHECK(std::abs(active[0][0] - 1.6) < 1e-15);
    CHECK(active[1][1] == 0.0);
}

TEST_CASE("fibres: in uniaxial stretch the stress is Holzapfel's")
{
    const FibreFamily family{.stiffness = 5.0, .exponent = 2.0};
    for (double s : {1.05, 1.2, 1.4, 1.7}) {
        const double e = s * s - 1.0, expected = 4.0 * 0.5 * family.stiffness * e * std::exp(2.0 * e * e) * s;
        const double found = fibreStress(family, {0, 1, 0}, Mat3::diagonal({1.0, s, 1.0}))[1][1];
        CHECK(std::abs(found - expected) < 1e-12 * expected);
    }
    // Beyond e^8 the exponential goes on as a parabola, and stays finite.
    CHECK(isFinite(fibreStress(family, {0, 1, 0}, Mat3::diagonal({1.0, 1e4, 1.0}))[1]));
}

TEST_CASE("fibres: dispersed in all directions, they do not know their own")
{
    std::mt19937 random(2);
    const FibreFamily family{.stiffness = 1.0, .exponent = 1.0, .dispersion = 1.0 / 3.0};
    const Mat3 f = Mat3::identity() + 0.3 * randomMat3(random, 1.0);
    CHECK(frobeniusNorm(fibreStress(family, randomDirection(random), f) -
                        fibreStress(family, randomDirection(random), f)) < 1e-14);
}

TEST_CASE("fibres: the stress turns with the tissue")
{
    std::mt19937 random(3);
    for (const FibreFamily& family : kFamilies) {
        const Vec3 a = randomDirection(random);
        const Mat3 f = Mat3::identity() + 0.3 * randomMat3(random, 1.0), r = toMat3(randomRotation(random));
        CHECK(frobeniusNorm(fibreStress(family, a, r * f) - r * fibreStress(family, a, f)) < 1e-13);
    }
}

TEST_CASE("fibres: blocks of elements match the double-precision element on every instruction set")
{
    onEveryTarget([&](const std::string&) {
        std::mt19937 random(4);
        for (const bool near : {true, false}) {
            Elements all(randomElements(random, 16 * 6 - 5, 0.4));
            for (ElementBlock& block : all.elementBlocks) std::fill_n(block.mu, kBlock, 0.0f); // fibres alone
            for (const FibreFamily& family : kFamilies) all.addFibres(family, random);
            for (int e = 0; e < all.count(); ++e)
                all.deform(e, toMat3(randomRotation(random)) *
                                  (Mat3::identity() + (near ? 0.1 : 0.4) * randomMat3(random, 1.0)));
            randomMotion(random, all);
            all.run();
            double forces = 0.0, products = 0.0;
            for (int e = 0; e < all.count(); ++e) {
                const FemElement& element = all.elements[static_cast<std::size_t>(e)];
                const Mat3 f = gradient(element, Elements::nodes(all.x, e));
                Mat3 stress, kv, kp;
                for (std::size_t k = 0; k < all.families.size(); ++k) {
                    const Vec3 a = all.directions[k][static_cast<std::size_t>(e)];
                    const FibreTangent t =
                        fibreTangent(all.families[k], a, f, static_cast<double>(kWeights.fibreTurning));
                    stress += fibreStress(all.families[k], a, f);
                    kv += stressChange(t, gradient(element, Elements::nodes(all.v, e)));
                    kp += stressChange(t, gradient(element, Elements::nodes(all.p, e)));
                }
                const double force = static_cast<double>(kWeights.force);
                const double stiffness = static_cast<double>(kWeights.fibreStiffness);
                const Corners elastic = internalForces(element, stress), rate = internalForces(element, kv);
                const Corners product = internalForces(element, kp);
                const double size = frobeniusNorm(stress) + frobeniusNorm(kv) + frobeniusNorm(kp) + 10.0;
                for (int i = 0; i < 4; ++i) {
                    const auto k = static_cast<std::size_t>(i);
                    const Vec3 got = vectorOf(Elements::corner(all.corners, e, i));
                    const Vec3 gotProduct = vectorOf(Elements::corner(all.products, e, i));
                    const double scale = element.volume * size * 10.0;
                    forces = std::max(forces, length(got + force * elastic[k] + stiffness * rate[k]) / scale);
                    products = std::max(products, length(gotProduct - stiffness * product[k]) / scale);
                }
            }
            // Stiffening fibres magnify the rounding of their strain.
            CHECK(forces < (near ? 1e-5 : 1e-4));
            CHECK(products < (near ? 1e-5 : 1e-4));
        }
    });
}

} // namespace fibre_test
