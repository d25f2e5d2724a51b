#include "filasofia/testing/fuzz_law_tissue.h"

#include <algorithm>
#include <cmath>

namespace filasofia::testing {
using namespace physics;
namespace {

Ogden randomOgden(FuzzRandom& random)
{
    Ogden law{.terms = {}};
    const int count = 1 + random.below(3);
    double left = 1.0;
    for (int i = 0; i < count; ++i) {
        const double exponent = random.chance(0.3) ? random.uniform(-8.0, -1.0) : random.uniform(1.0, 12.0);
        const double share = i + 1 == count ? left : left * random.uniform(0.2, 0.8);
        law.terms.push_back({exponent, share});
        left -= share;
    }
    return law;
}

struct LawMaker {
    FuzzRandom& random;

    /// Any law: numbers of its fields' ranges.
    template <class Law> void operator()(Law& law) const
    {
        forEachField<Law>([&](const auto& each) {
            const Range& range = each.range;
            law.*(each.member) =
                range.low > 0.0 ? random.logarithmic(range.low, range.high) : random.uniform(range.low, range.high);
        });
    }
    void operator()(Ogden& law) const { law = randomOgden(random); }
    void operator()(VerondaWestmann& law) const { law.exponent = random.logarithmic(0.2, 20.0); }
    void operator()(Fung& law) const { law.exponent = random.logarithmic(0.05, 20.0); }
};

std::vector<FibreFamily> randomFibres(double youngModulus, FuzzRandom& random)
{
    std::vector<FibreFamily> families;
    const int count = 1 + random.below(2);
    for (int i = 0; i < count; ++i) {
        FibreFamily family{.stiffness = youngModulus * random.logarithmic(0.05, 3.0),
                           .exponent = random.logarithmic(0.1, 10.0),
                           .dispersion = random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0 / 3.0)};
        if (random.chance(0.3)) family.activeStress = youngModulus * random.uniform(0.0, 0.5);
        if (random.chance(0.5))
            family.direction = Along{random.direction()};
        else
            family.direction = Around{.axis = random.direction(), .pitch = random.uniform(-1.5, 1.5)};
        families.push_back(family);
    }
    return families;
}

TissueRegion randomRegion(const FemMaterial& material, double size, FuzzRandom& random)
{
    TissueRegion region{.where = Ball{.centre = 0.4 * size * random.direction(), .radius = 0.5 * size}};
    if (random.chance(0.3)) region.where = NearSurface{.depth = 0.15 * size};
    region.youngModulus = material.youngModulus * random.logarithmic(0.2, 5.0);
    if (random.chance(0.3)) region.poissonRatio = random.uniform(0.2, random.chance(0.2) ? 0.499 : 0.45);
    if (random.chance(0.3)) region.restScale = random.uniform(0.8, 1.2);
    if (random.chance(0.5) && std::isfinite(material.tearingThreshold))
        region.tearingThreshold = material.tearingThreshold * random.logarithmic(0.2, 2.0);
    if (random.chance(0.2)) region.yieldStress = material.youngModulus * random.logarithmic(0.1, 1.0);
    return region;
}

double randomPoisson(FuzzRandom& random)
{
    const double which = random.uniform(0.0, 1.0);
    if (which < 0.9) return random.uniform(0.0, 0.45);
    if (which < 0.97) return random.uniform(0.45, 0.49);
    return 0.5 - random.logarithmic(1e-4, 1e-2);
}

} // namespace

ElasticLaw randomLaw(std::size_t alternative, FuzzRandom& random)
{
    ElasticLaw law = elasticLaws().at(alternative);
    std::visit(LawMaker{random}, law);
    return law;
}

FemMaterial randomTissue(std::size_t alternative, double size, FuzzRandom& random, LawFuzzReport& report)
{
    FemMaterial material{.youngModulus = random.logarithmic(1e3, 1e5),
                         .poissonRatio = randomPoisson(random),
                         .law = randomLaw(alternative, random)};
    report.nearlyIncompressible += material.poissonRatio > 0.45 ? 1 : 0;
    if (random.chance(0.5)) material.tearingThreshold = material.youngModulus * random.logarithmic(0.2, 3.0);
    if (random.chance(0.4)) {
        material.fibres = randomFibres(material.youngModulus, random);
        ++report.fibres;
    }
    if (random.chance(0.3)) {
        material.relaxation = {{.share = random.uniform(0.1, 0.6), .time = random.logarithmic(1e-3, 1.0)}};
        if (random.chance(0.5)) material.relaxation.push_back({.share = 0.3, .time = random.logarithmic(1e-3, 10.0)});
        ++report.relaxing;
    }
    if (random.chance(0.2)) {
        material.yieldStress = material.youngModulus * random.logarithmic(0.05, 1.0);
        ++report.flowing;
    }
    if (random.chance(0.3)) {
        material.regions = {randomRegion(material, size, random)};
        ++report.regions;
    }
    return material;
}

ShellMaterial randomShell(double size, FuzzRandom& random)
{
    ShellMaterial material{.youngModulus = random.logarithmic(1e4, 1e6),
                           .poissonRatio = random.uniform(0.0, 0.49),
                           .thickness = size * random.logarithmic(0.005, 0.05)};
    if (random.chance(0.2)) material.bendingScale = 0.0;
    if (random.chance(0.5)) material.tearingThreshold = material.youngModulus * random.logarithmic(0.1, 2.0);
    return material;
}

} // namespace filasofia::testing
