#pragma once

#include <filasofia/filasofia.h>

#include <string>
#include <vector>

/// The patient: a uterus, and a polyp in a place that the seed chooses.
namespace hysteroscopy {

/// Where a polyp may grow.
struct Site {
    filasofia::Vec3 at = {};     ///< [m], in the wall's surface
    filasofia::Vec3 normal = {}; ///< unit, into the cavity
    double free = 0.0;           ///< [m], to the wall opposite
};

struct Polyp {
    std::string name = {};
    double height = 0.0;        ///< [m]
    double width = 0.0;         ///< [m]
    std::vector<int> base = {}; ///< nodes of its root
};

struct Patient {
    Polyp polyp = {};
    Site site = {};
    filasofia::Pose pose = {};   ///< of the polyp
    filasofia::Vec3 middle = {}; ///< [m], of its head
    std::string problem = {};    ///< why nobody could treat it; empty: somebody could
};

/// The axis of the scope goes through this point, whatever it looks at: the canal holds it. [m]
inline constexpr filasofia::Vec3 kFulcrum = {0.0, 0.024, 0.0};

/// The names of the cases.
std::vector<std::string> cases();
/// The patient of a case and seed: always the same. Throws Error where there is no such case.
Patient makePatient(const std::string& caseName, std::uint64_t seed);

struct Bodies {
    filasofia::BodyId uterus = {};
    filasofia::BodyId polyp = {};
};
Bodies addPatient(filasofia::Simulation& sim, const Patient& patient);

} // namespace hysteroscopy
