#pragma once

#include <filasofia/filasofia.h>

#include <string>
#include <vector>

/// A uterus with a polyp, or with a myoma, at a site chosen by the seed.
namespace hysteroscopy {

struct Patient {
    enum class Kind { Polyp, Myoma };
    Kind kind = Kind::Polyp;
    std::string polyp = {};      ///< base name of the polyp's or the myoma's files
    double height = 0.0;         ///< [m] its height
    double width = 0.0;          ///< [m] its width
    double wideFrom = 0.0;       ///< [m] height above which the cavity is wide enough for it; infinite: nowhere
    std::vector<int> base = {};  ///< nodes of its root
    filasofia::Pose pose = {};   ///< pose of the polyp: root in the wall, +Y pointing out of it
    filasofia::Vec3 normal = {}; ///< unit vector pointing out of the wall
    double free = 0.0;           ///< [m] distance to the opposite wall
    filasofia::Vec3 middle = {}; ///< [m] the point at which forceps take it; of a myoma, its middle
    std::string problem = {};    ///< why it cannot be treated; empty if it can
};

/// [m] The axis of the scope always passes through this point, because the canal guides it.
inline constexpr filasofia::Vec3 kFulcrum = {0.0, 0.024, 0.0};
/// Collision groups. Scope and forceps never collide with each other.
enum Group { ScopeWall, ForcepsWall, ScopePolyp, ForcepsPolyp, PolypWall, LoopWall, LoopMyoma };

inline const std::vector<std::string> kCases = {"small", "medium", "lobed", "resection"};
/// The patient of a case and a seed, always the same. Throws Error if there is no such case.
Patient makePatient(const std::string& caseName, std::uint64_t seed);

struct Bodies {
    filasofia::BodyId uterus = {};
    filasofia::BodyId polyp = {}; ///< or the myoma
};
Bodies addPatient(filasofia::Simulation& sim, const Patient& patient);

} // namespace hysteroscopy
