#include "apps/filasofia/commands.h"
#include "filasofia/core/error.h"
#include "filasofia/physics/tissue.h"

#include <cstdio>
#include <memory>

namespace filasofia::app {
namespace {

using physics::Tissue;

std::string kilopascals(double pascals)
{
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.4g", 1e-3 * pascals);
    return shown;
}

std::string extrasOf(const Tissue& tissue)
{
    std::string out(nameOf(tissue.material.law));
    if (!tissue.material.fibres.empty()) out += ", fibres";
    if (!tissue.material.relaxation.empty()) out += ", relaxes";
    return out;
}

void printAll()
{
    std::printf("%-16s %8s %15s %5s %8s %12s  %s\n", "tissue", "E [kPa]", "published", "nu", "kg/m^3", "strength",
                "law");
    for (const Tissue& each : physics::tissues()) {
        const std::string range = kilopascals(each.lowest) + " - " + kilopascals(each.highest);
        std::printf("%-16s %8s %15s %5.2f %8.0f %12s  %s\n", std::string(each.name).c_str(),
                    kilopascals(each.material.youngModulus).c_str(), range.c_str(), each.material.poissonRatio,
                    each.density, each.strength > 0.0 ? (kilopascals(each.strength) + " kPa").c_str() : "unknown",
                    extrasOf(each).c_str());
    }
    std::printf(
        "\nWith a name, sources and caveats: filasofia tissues liver. In a program: tissue(\"liver\").material\n");
}

void print(const Tissue& tissue)
{
    const physics::FemMaterial& material = tissue.material;
    const auto line = [](const char* what, const std::string& value) {
        std::printf("%-16s %s\n", what, value.c_str());
    };
    line("tissue", text(tissue.name, ": ", tissue.title));
    line("Young's modulus", text(kilopascals(material.youngModulus), " kPa; published: ", kilopascals(tissue.lowest),
                                 " to ", kilopascals(tissue.highest), " kPa"));
    line("Poisson's ratio", text(material.poissonRatio));
    line("law", extrasOf(tissue));
    for (const physics::FibreFamily& family : material.fibres)
        line("fibres", text("k1 ", kilopascals(family.stiffness), " kPa, k2 ", family.exponent));
    for (const physics::PronyTerm& term : material.relaxation)
        line("relaxes", text(100.0 * term.share, " % in ", term.time, " s"));
    if (material.validStrain < 1e300) line("measured up to", text("strain ", material.validStrain));
    line("density", text(tissue.density, " kg/m^3"));
    line("strength", tissue.strength > 0.0 ? kilopascals(tissue.strength) + " kPa" : "unknown");
    line("source", std::string(tissue.source));
    line("caveat", std::string(tissue.caveat));
}

} // namespace

Command tissuesCommand()
{
    auto name = std::make_shared<std::string>();
    return {
        .name = "tissues",
        .meaning = "List the tissue library: constants, ranges, sources",
        .options = {{.name = "NAME", .target = name.get(), .meaning = "Print this tissue in full", .standard = "all"}},
        .run = [name] {
            if (name->empty())
                printAll();
            else
                print(physics::tissue(*name));
            return 0;
        }};
}

} // namespace filasofia::app
