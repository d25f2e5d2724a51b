#include "verification/verification.h"

#include <functional>

/// Elastic laws against closed forms: one element under homogeneous deformations. The bodies are as good as
/// incompressible, so that the closed forms of incompressible laws hold to 1e-3 and the lateral stretch is known.
namespace law_verification_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kMu = 1000.0, kNu = 0.49999;
const Lame kMaterial = lame(2.0 * kMu * (1.0 + kNu), kNu);

/// The stress along x and the lateral stretch.
struct Free {
    double stress, lateral; ///< Cauchy [Pa]
};
/// With the stresses along the other free axes zero: `shape` makes the deformation gradient from the stretch and the
/// lateral stretch, which is sought.
Free freely(const ElasticLaw& law, Lame material, double stretch, const std::function<Vec3(double, double)>& shape)
{
    double low = 0.2, high = 6.0; // lateral stretches: the lateral stress rises with them
    const auto stressOf = [&](double lateral) {
        const Mat3 f = Mat3::diagonal(shape(stretch, lateral));
        return cauchyStress(law, material, {f, Mat3::identity()});
    };
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (stressOf(middle)[2].z < 0.0 ? low : high) = middle;
    }
    return {stressOf(0.5 * (low + high))[0].x, 0.5 * (low + high)};
}

Free uniaxially(const ElasticLaw& law, Lame material, double stretch)
{
    return freely(law, material, stretch, [](double s, double t) { return Vec3{s, t, t}; });
}
double uniaxial(const ElasticLaw& law, Lame material, double stretch)
{
    return uniaxially(law, material, stretch).stress;
}
double equibiaxial(const ElasticLaw& law, double stretch)
{
    return freely(law, kMaterial, stretch, [](double s, double t) { return Vec3{s, s, t}; }).stress;
}
double simpleShear(const ElasticLaw& law, Lame material, double shear)
{
    const Mat3 f{{{1, shear, 0}, {0, 1, 0}, {0, 0, 1}}};
    return cauchyStress(law, material, deformation(f))[0].y;
}

/// Stress over stretch (or shear) of an incompressible law.
using Closed = std::function<double(double)>;
struct Forms {
    std::string name;
    ElasticLaw law;
    Closed uniaxial, equibiaxial, shear;
};

double squared(double a) { return a * a; }

/// sigma = 2 (s^2 - 1/s) (W1 + W2 / s), 2 (s^2 - 1/s^4) (W1 + W2 s^2) and 2 (W1 + W2) shear for a law of the invariants
/// with the derivatives w1(i1) and w2 (e.g. Holzapfel 2000, section 6.5).
Forms ofInvariants(std::string name, const ElasticLaw& law, const Closed& w1, double w2)
{
    return {std::move(name), law, [=](double s) { return 2 * (s * s - 1 / s) * (w1(s * s + 2 / s) + w2 / s); },
            [=](double s) { return 2 * (s * s - std::pow(s, -4)) * (w1(2 * s * s + std::pow(s, -4)) + w2 * s * s); },
            [=](double g) { return 2 * g * (w1(3 + g * g) + w2); }};
}

std::vector<Forms> closedForms()
{
    std::vector<Forms> all;
    const auto constant = [](double value) { return [=](double) { return value; }; };
    all.push_back(ofInvariants("neo-Hookean", NeoHookean{}, constant(0.5 * kMu), 0.0));
    all.push_back(ofInvariants("Mooney-Rivlin", MooneyRivlin{.share = 0.3}, constant(0.35 * kMu), 0.15 * kMu));
    all.push_back(ofInvariants(
        "Veronda-Westmann", VerondaWestmann{.exponent = 0.6}, [](double i1) { return kMu * std::exp(0.6 * (i1 - 3)); },
        -0.5 * kMu));
    all.push_back(ofInvariants(
        "Fung", Fung{.exponent = 0.8}, [](double i1) { return 0.5 * kMu * std::exp(0.8 * (i1 - 3)); }, 0.0));
    all.push_back(ofInvariants(
        "Gent", Gent{.limit = 2.5}, [](double i1) { return 0.5 * kMu * 2.5 / (2.5 - (i1 - 3)); }, 0.0));
    const Ogden ogden{.terms = {{.exponent = 1.3, .share = 0.5}, {5.0, 0.2}, {-2.0, 0.3}}};
    const auto sum = [terms = ogden.terms](const std::function<double(double)>& ofExponent) {
        double total = 0.0;
        for (const OgdenTerm& term : terms) total += 2 * kMu * term.share / term.exponent * ofExponent(term.exponent);
        return total;
    };
    all.push_back({"Ogden", ogden,
                   [=](double s) { return sum([&](double a) { return std::pow(s, a) - std::pow(s, -0.5 * a); }); },
                   [=](double s) { return sum([&](double a) { return std::pow(s, a) - std::pow(s, -2 * a); }); },
                   [=](double g) {
                       const double s = 0.5 * g + std::sqrt(1 + 0.25 * g * g); // the largest principal stretch
                       return sum([&](double a) { return std::pow(s, a) - std::pow(s, -a); }) / (s + 1 / s);
                   }});
    return all;
}

} // namespace

TEST_CASE("every law is compared with closed forms")
{
    const std::vector<Forms> forms = closedForms();
    for (const ElasticLaw& law : elasticLaws()) {
        INFO(nameOf(law));
        const bool compressible = // below
            std::holds_alternative<StVenantKirchhoff>(law) || std::holds_alternative<Corotational>(law);
        CHECK((compressible ||
               std::ranges::any_of(forms, [&](const Forms& each) { return each.law.index() == law.index(); })));
    }
}

TEST_CASE("laws in uniaxial tension and compression, equibiaxial tension and simple shear match their closed forms")
{
    for (const Forms& each : closedForms()) {
        double uniaxialError = 0.0, biaxialError = 0.0, shearError = 0.0;
        const auto compare = [](double found, double expected, double& worst) {
            worst = std::max(worst, std::abs(found - expected) / (std::abs(expected) + 0.1 * kMu));
        };
        for (const double s : {0.5, 0.6, 0.8, 0.95, 1.05, 1.25, 1.5, 1.75, 2.0}) {
            compare(uniaxial(each.law, kMaterial, s), each.uniaxial(s), uniaxialError);
            if (s > 0.7 && s < 1.6) compare(equibiaxial(each.law, s), each.equibiaxial(s), biaxialError);
            compare(simpleShear(each.law, kMaterial, s - 0.5), each.shear(s - 0.5), shearError);
        }
        verify(each.name + ", uniaxial stress from stretch 0.5 to 2, relative error", uniaxialError, 1e-3);
        verify(each.name + ", equibiaxial stress from stretch 0.8 to 1.5, relative error", biaxialError, 1e-3);
        verify(each.name + ", shear stress up to shear 1.5, relative error", shearError, 1e-3);
    }
}

TEST_CASE("the compressible laws have closed forms at any Poisson's ratio")
{
    const double young = 3000.0;
    for (const double nu : {0.0, 0.3, 0.45}) {
        const Lame material = lame(young, nu);
        double saintVenant = 0.0, corotational = 0.0, shearing = 0.0, turned = 0.0;
        const auto compare = [&](double found, double expected, double& worst) {
            worst = std::max(worst, std::abs(found - expected) / (std::abs(expected) + 0.1 * young));
        };
        for (const double s : {0.7, 0.9, 1.1, 1.4}) {
            const double strain = 0.5 * (s * s - 1), lateral2 = 1 - nu * (s * s - 1), g = s - 0.5;
            compare(uniaxial(StVenantKirchhoff{}, material, s), young * strain * s / lateral2, saintVenant);
            const double lateral = 1 - nu * (s - 1);
            compare(uniaxial(Corotational{}, material, s), young * (s - 1) / squared(lateral), corotational);
            const auto [mu, lambda] = material;
            compare(simpleShear(StVenantKirchhoff{}, material, g), mu * g + g * g * g * (0.5 * lambda + mu), shearing);
            const double root = std::sqrt(4 + g * g);
            compare(simpleShear(Corotational{}, material, g), 2 * mu * (g - g / root) + lambda * (root - 2) * g / root,
                    turned);
        }
        verify(text("St Venant-Kirchhoff, uniaxial, nu ", nu, ", relative error"), saintVenant, 1e-9);
        verify(text("St Venant-Kirchhoff, simple shear, nu ", nu, ", relative error"), shearing, 1e-9);
        verify(text("corotational, uniaxial, nu ", nu, ", relative error"), corotational, 1e-9);
        verify(text("corotational, simple shear, nu ", nu, ", relative error"), turned, 1e-9);
    }
}

TEST_CASE("neo-Hookean tissue of any Poisson's ratio presses back ever more, down to 15 % of its height")
{
    for (const double nu : {0.0, 0.03, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49}) {
        double last = 0.0;
        for (double height = 0.95; height > 0.149; height -= 0.025) {
            CAPTURE(nu, height);
            const Free at = uniaxially(NeoHookean{}, lame(3000.0, nu), height);
            const double pressure = -at.stress * squared(at.lateral); // per area at rest
            CHECK(pressure > last);
            last = pressure;
        }
    }
    // Without a Poisson's ratio it stays as wide as it is: J = s, and mu (1/s - s) presses back.
    double error = 0.0, wider = 0.0;
    for (const double s : {0.9, 0.7, 0.5, 0.3}) {
        const Free at = uniaxially(NeoHookean{}, lame(2.0 * kMu, 0.0), s);
        error = std::max(error, std::abs(at.stress / (kMu * (s - 1.0 / s)) - 1.0));
        wider = std::max(wider, std::abs(at.lateral - 1.0));
    }
    verify("neo-Hookean, nu 0, pressed to 0.3 of its height, relative error of the stress", error, 1e-9);
    verify("neo-Hookean, nu 0, pressed to 0.3 of its height, lateral strain", wider, 1e-9);
}

} // namespace law_verification_test
