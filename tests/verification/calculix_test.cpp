#include "verification/calculix/deck.h"
#include "verification/verification.h"

namespace calculix_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

const std::string kFolder = FILASOFIA_SOURCE_DIR "/tests/verification/calculix/";

/// A body in its deck's state of rest, found by the engine's own implicit steps under the deck's loads times `factor`.
struct Rest {
    Stage stage;
    std::vector<Vec3> u; ///< [m] displacements

    /// The nodal forces rise to their values in the first `rise` steps.
    Rest(Deck deck, double factor, int steps, double dt, int rise = 0)
    {
        deck.def.solver = Cholesky{};
        deck.def.pressure *= factor;
        for (NodalForce& each : deck.def.forces) each.force *= factor;
        const BodyId body = stage.add(deck.def);
        stage.post(SetGravity{factor * deck.gravity});
        for (int i = 1; i < rise; ++i) {
            std::vector<NodalForce> forces = deck.def.forces;
            for (NodalForce& each : forces) each.force *= static_cast<double>(i) / rise;
            stage.post(SetForces{body, forces});
            CHECK(stage.step(dt).flags == 0);
        }
        if (rise > 0) stage.post(SetForces{body, deck.def.forces});
        CHECK(stage.run(steps, dt).flags == 0);
        const std::vector<Vec3> before = stage.soft().x;
        CHECK(stage.run(1, dt).flags == 0);
        for (std::size_t i = 0; i < before.size(); ++i) u.push_back(stage.soft().x[i] - stage.model().rest[i]);
        CHECK(largest(difference(stage.soft().x, before)) < 1e-7 * largest(u)); // it is at rest
    }

    static std::vector<Vec3> difference(std::vector<Vec3> a, const std::vector<Vec3>& b)
    {
        REQUIRE(a.size() == b.size());
        for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
        return a;
    }
    static double largest(const std::vector<Vec3>& vectors)
    {
        double highest = 0.0;
        for (Vec3 each : vectors) highest = std::max(highest, length(each));
        return highest;
    }
    static double gap(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
    {
        return largest(difference(a, b)) / largest(b);
    }
};

/// The material of a deck with another law.
FemMaterial withLaw(const Deck& deck, const ElasticLaw& law)
{
    FemMaterial material = std::get<FemMaterial>(deck.def.material);
    material.law = law;
    return material;
}

/// Compares the engine's linear response with CalculiX's, which is linear. A load and its opposite have the same linear
/// part; they differ by the change of geometry, which only the engine includes.
void verifyLinear(const std::string& what, const std::string& name)
{
    const Deck deck = readDeck(kFolder + name + ".inp");
    const std::vector<Vec3> expected = readDisplacements(kFolder + name + ".csv");
    const std::vector<Vec3> there = Rest(deck, 1.0, 8, 1e3).u, back = Rest(deck, -1.0, 8, 1e3).u;
    std::vector<Vec3> linear = Rest::difference(there, back);
    for (Vec3& each : linear) each *= 0.5;
    verify(what + " against CalculiX, largest difference over largest displacement", Rest::gap(linear, expected), 5e-7);
    verify(what + ", the same with the change of geometry left in", Rest::gap(there, expected), 1e-4);
}

/// The largest |R^T F - I| of all elements.
double largestStrain(Stage& stage)
{
    double strain = 0.0;
    const std::vector<Vec3>& x = stage.soft().x;
    for (const FemElement& e : stage.model().elements) {
        const Mat3 f = gradient(e, {x[e.nodes[0]], x[e.nodes[1]], x[e.nodes[2]], x[e.nodes[3]]});
        strain = std::max(strain, frobeniusNorm(f - nearestRotation(f)));
    }
    return strain;
}

} // namespace

TEST_CASE("a clamped beam sags under its weight as in CalculiX")
{
    verifyLinear("clamped beam under its weight", "sagging_beam");
}

TEST_CASE("a ball around a rigid core yields to pressure as in CalculiX")
{
    verifyLinear("ball under pressure", "pressed_ball");
}

TEST_CASE("a ball around a rigid core yields to pressure almost as Lame's shell does")
{
    const Deck deck = readDeck(kFolder + "pressed_ball.inp");
    const FemMaterial material = std::get<FemMaterial>(deck.def.material);
    const auto [mu, lambda] = lame(material.youngModulus, material.poissonRatio);
    constexpr double radius = 0.03, core = 0.01; // [m]
    // Lame 1852: u = A r + B / r^2, no displacement at the core, a radial stress of minus the pressure at the outer
    // surface.
    const double ratio = std::pow(core / radius, 3.0);
    const double a = -deck.def.pressure / (3.0 * lambda + 2.0 * mu + 4.0 * mu * ratio);
    const double expected = a * radius * (1.0 - ratio);

    Rest ball(deck, 1.0, 8, 1e3);
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < ball.u.size(); ++i) {
        const Vec3 p = ball.stage.model().rest[i];
        if (length(p) < 0.999 * radius) continue;
        sum += dot(ball.u[i], p) / length(p);
        ++count;
    }
    verifyWithin("ball under pressure, two elements thick, mean displacement of its surface over Lame's",
                 sum / count / expected, 0.95, 1.0);
}

TEST_CASE("a slender beam with large bending deforms as in CalculiX")
{
    // CalculiX is linear in Green's strain: its law is St Venant's and Kirchhoff's. The corotational law is linear in
    // the corotated strain: in a stretched bar of strain e the two stresses differ by 3/2 e. In bending the stretched
    // and the compressed side differ in opposite directions, which cancels most of the difference; the rest must still
    // fall with the strain.
    Deck deck = readDeck(kFolder + "bent_beam.inp");
    std::vector<double> gaps;
    for (const auto& [name, factor] : {std::pair{"half_bent_beam", 0.5}, std::pair{"bent_beam", 1.0}}) {
        const std::vector<Vec3> expected = readDisplacements(kFolder + name + ".csv");
        deck.def.material = withLaw(deck, StVenantKirchhoff{});
        verify(text("St Venant-Kirchhoff beam bent far, ", 100 * factor,
                    " % of the load, against CalculiX, largest difference over largest displacement"),
               Rest::gap(Rest(deck, factor, 200, 1.0).u, expected), 1e-5);
        deck.def.material = withLaw(deck, Corotational{});
        Rest beam(deck, factor, 60, 1.0);
        gaps.push_back(Rest::gap(beam.u, expected));
        const std::string what = text("beam bent far, ", 100 * factor, " % of the load, ");
        tell(what + "CalculiX's largest displacement over length", Rest::largest(expected));
        verify(what + "largest strain", largestStrain(beam.stage), 0.02);
        verify(what + "against CalculiX, largest difference over largest displacement", gaps.back(), 1e-3);
    }
    verifyWithin("beam bent far, difference at the whole load over that at half", gaps[1] / gaps[0], 1.5, 2.5);
}

TEST_CASE("hyperelastic blocks pulled and bent far deform as in CalculiX")
{
    // regenerate.py: mu = 10 kPa, K = 46.7 kPa. CalculiX's NEO HOOKE is Mooney-Rivlin without the second invariant.
    const std::tuple<const char*, const char*, ElasticLaw> blocks[] = {
        {"neo_hooke_block", "neo-Hookean at constant volume", MooneyRivlin{.share = 0.0}},
        {"mooney_rivlin_block", "Mooney-Rivlin", MooneyRivlin{.share = 0.3}},
        {"ogden_block", "Ogden", Ogden{.terms = {{.exponent = 4.0}}}},
    };
    for (const auto& [file, name, law] : blocks)
        for (const auto& [half, factor] : {std::pair{"half_", 0.5}, std::pair{"", 1.0}}) {
            Deck deck = readDeck(kFolder + file + ".inp");
            deck.def.material = FemMaterial{.youngModulus = 28e3, .poissonRatio = 0.4, .law = law};
            Rest block(deck, factor, 200, 0.02, 100);
            const std::vector<Vec3> expected = readDisplacements(kFolder + half + file + ".csv");
            tell(text(name, " block, ", 100 * factor, " % of the load, CalculiX's largest displacement [m]"),
                 Rest::largest(expected));
            tell(text(name, " block, ", 100 * factor, " % of the load, largest strain"), largestStrain(block.stage));
            verify(text(name, " block, ", 100 * factor,
                        " % of the load, against CalculiX, largest difference over largest displacement"),
                   Rest::gap(block.u, expected), 1e-5);
        }
}

} // namespace calculix_test
