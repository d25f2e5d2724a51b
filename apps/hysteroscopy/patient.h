#pragma once

#include <filasofia/filasofia.h>

#include <string>
#include <vector>

/// A uterus, and a polyp in a place that the seed chooses.
namespace hysteroscopy {

struct Patient {
    std::string polyp = {};      ///< the name of its files
    double height = 0.0;         ///< [m], of the polyp
    double width = 0.0;          ///< [m]
    std::vector<int> base = {};  ///< nodes of its root
    filasofia::Pose pose = {};   ///< of the polyp: its root in the wall, +Y out of it
    filasofia::Vec3 normal = {}; ///< unit, out of the wall
    double free = 0.0;           ///< [m], to the wall opposite
    filasofia::Vec3 middle = {}; ///< [m], where forceps take it
    std::string problem = {};    ///< why nobody could treat it; empty: somebody could
};

/// The axis of the scope goes through this point, whatever it looks at: the canal holds it. [m]
inline constexpr filasofia::Vec3 kFulcrum = {0.0, 0.024, 0.0};
/// Who touches whom: scope and forceps never each other, nor the polyp its wall.
enum Group { ScopeWall, ForcepsWall, ScopePolyp, ForcepsPolyp };

inline const std::vector<std::string> kCases = {"small", "medium", "lobed"};
/// The patient of a case and seed: always the same. Throws Error where there is no such case.
Patient makePatient(const std::string& caseName, std::uint64_t seed);

struct Bodies {
    filasofia::BodyId uterus = {};
    filasofia::BodyId polyp = {};
};
Bodies addPatient(filasofia::Simulation& sim, const Patient& patient);

} // namespace hysteroscopy
