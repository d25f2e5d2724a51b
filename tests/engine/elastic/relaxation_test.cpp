#include "filasofia/engine/elastic/relaxation.h"

#include "engine/elastic/element_blocks.h"

namespace relaxation_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::PronyTerm;

namespace {

const std::vector<PronyTerm> kTerms{{.share = 0.4, .time = 0.05}, {.share = 0.3, .time = 2.0}};

double relaxationAt(double t)
{
    double out = 1.0;
    for (const PronyTerm& term : kTerms) out -= term.share * (1.0 - std::exp(-t / term.time));
    return out;
}

} // namespace

TEST_CASE("relaxation: stress held still follows the Prony series, whatever the steps")
{
    for (double dt : {1e-4, 0.01, 0.3}) {
        ElementRelaxation state;
        const Mat3 stress = Mat3::diagonal({1.0, -0.5, 0.2});
        updateRelaxation(relaxationStep(kTerms, 0.0, 0.0), stress, 3, state); // sudden
        double time = 0.0;
        for (int step = 0; step < 40; ++step) {
            const Mat3 end = relaxedStress(relaxationStep(kTerms, 0.0, dt), stress, 3, state);
            time += dt;
            CHECK(std::abs(end[0][0] - relaxationAt(time)) < 2e-6);
            CHECK(std::abs(end[1][1] + 0.5 * relaxationAt(time)) < 2e-6);
            updateRelaxation(relaxationStep(kTerms, dt, 0.0), stress, 3, state);
        }
    }
}

TEST_CASE("relaxation: stress that grows at a constant rate follows the integral exactly, whatever the steps")
{
    // T = t: the stress is the integral of G.
    const auto expected = [](double t) {
        double out = t;
        for (const PronyTerm& term : kTerms) out -= term.share * (t - term.time * (1.0 - std::exp(-t / term.time)));
        return out;
    };
    for (double dt : {1e-3, 0.1, 1.0}) {
        ElementRelaxation state;
        for (int step = 0; step < 30; ++step) {
            const double end = dt * (step + 1);
            const Mat3 now = relaxedStress(relaxationStep(kTerms, 0.0, dt), end * Mat3::identity(), 0, state);
            CHECK(std::abs(now[2][2] - expected(end)) < 3e-6 * (1.0 + end));
            updateRelaxation(relaxationStep(kTerms, dt, 0.0), end * Mat3::identity(), 0, state);
        }
    }
}

TEST_CASE("relaxation: the stress at the end of a step is that of its start plus the tangent times the change")
{
    std::mt19937 random(1);
    ElementRelaxation state;
    const auto symmetric = [&] {
        const Mat3 m = randomMat3(random, 1.0);
        return 0.5 * (m + transpose(m));
    };
    const RelaxationStep step = relaxationStep(kTerms, 0.02, 0.03);
    updateRelaxation(step, symmetric(), 5, state);
    const Mat3 start = symmetric(), change = symmetric();
    const Mat3 carried = updateRelaxation(step, start, 5, state);
    const Mat3 end = relaxedStress(step, start + change, 5, state);
    CHECK(frobeniusNorm(end - carried - step.tangent * change) < 1e-6);
    CHECK(std::abs(step.tangent - relaxationTangent(kTerms, 0.03)) < 1e-15);
}

TEST_CASE("relaxation: a second update without time between changes nothing")
{
    ElementRelaxation state, once;
    updateRelaxation(relaxationStep(kTerms, 0.01, 0.01), Mat3::identity(), 0, state);
    once = state;
    updateRelaxation(relaxationStep(kTerms, 0.0, 0.01), Mat3::identity(), 0, state);
    CHECK(std::memcmp(&once, &state, sizeof state) == 0);
}

TEST_CASE("relaxation: blocks of elements match the double-precision element on every instruction set")
{
    onEveryTarget([&](const std::string&) {
        std::mt19937 random(2);
        for (const auto& named : everyLaw()) {
            Elements all(randomElements(random, 16 * 6 - 5, 0.4), named.law);
            all.step = relaxationStep(kTerms, 0.02, 0.02);
            all.relaxation.resize(all.rotations.size());
            std::vector<ElementRelaxation> expected = all.relaxation;
            for (int round = 0; round < 3; ++round) {
                for (int e = 0; e < all.count(); ++e)
                    all.deform(e, toMat3(randomRotation(random)) * (Mat3::identity() + 0.2 * randomMat3(random, 1.0)));
                all.run();
                double forces = 0.0;
                for (int e = 0; e < all.count(); ++e) {
                    const FemElement& element = all.elements[static_cast<std::size_t>(e)];
                    const Deformation at{gradient(element, Elements::nodes(all.x, e)),
                                         toMat3(normalized(all.rotation(e)))};
                    const Lame material = lameOf(element);
                    const Mat3 stress = transposeTimes(at.rotation, stressAt(named.law, material, at));
                    const Mat3 total =
                        material.mu * (at.rotation * updateRelaxation(*all.step, 1.0 / material.mu * stress,
                                                                      static_cast<std::size_t>(e % kBlock),
                                                                      expected[static_cast<std::size_t>(e / kBlock)]));
                    const Corners force = internalForces(element, total);
                    const double scale = element.volume * material.mu * (10.0 + frobeniusNorm(stress) / material.mu);
                    for (int i = 0; i < 4; ++i)
                        forces = std::max(
                            forces, length(vectorOf(Elements::corner(all.corners, e, i)) +
                                           static_cast<double>(kWeights.force) * force[static_cast<std::size_t>(i)]) /
                                        scale);
                }
                INFO(named.name);
                CHECK(forces < 5e-5); // Gent near its limit: 3.5e-5, all others 2e-5
            }
        }
    });
}

} // namespace relaxation_test
