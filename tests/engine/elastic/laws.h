#pragma once

#include "filasofia/engine/elastic/law.h"
#include "filasofia/math/polar.h"

#include <string>
#include <vector>

/// Elastic laws for tests that hold for all of them, and one element under a law.
namespace filasofia::engine {

struct NamedLaw {
    std::string name;
    physics::ElasticLaw law;
};

/// Every law with its defaults, in the order of the variant: a law that is added there is tested. Then some with
/// constants of tissue.
inline std::vector<NamedLaw> everyLaw()
{
    std::vector<NamedLaw> laws;
    for (const physics::ElasticLaw& law : physics::elasticLaws())
        laws.push_back({std::string(physics::nameOf(law)), law});
    laws.push_back({"MooneyRivlin 0.5", physics::MooneyRivlin{.share = 0.5}});
    laws.push_back({"Ogden -4.7", physics::Ogden{.terms = {{.exponent = -4.7}}}}); // brain
    laws.push_back(
        {"Ogden 3 terms", physics::Ogden{.terms = {{.exponent = 1.3, .share = 0.6}, {5.0, 0.1}, {-2.0, 0.3}}}});
    laws.push_back({"VerondaWestmann 5", physics::VerondaWestmann{.exponent = 5.0}}); // skin
    laws.push_back({"Fung 10", physics::Fung{.exponent = 10.0}});
    laws.push_back({"Gent 0.4", physics::Gent{.limit = 0.4}}); // taut at 1.4 times its length
    return laws;
}

inline Deformation deformation(const Mat3& f) { return {f, toMat3(polarRotation(f, {}))}; }

/// [J]
inline double energyOf(const physics::ElasticLaw& law, const FemElement& element, const Corners& x)
{
    return element.volume * energyDensity(law, lameOf(element), deformation(gradient(element, x)));
}

/// [N] on the four nodes
inline Corners forcesOf(const physics::ElasticLaw& law, const FemElement& element, const Corners& x)
{
    Corners forces = internalForces(element, stressAt(law, lameOf(element), deformation(gradient(element, x))));
    for (Vec3& each : forces) each = -each;
    return forces;
}

} // namespace filasofia::engine
