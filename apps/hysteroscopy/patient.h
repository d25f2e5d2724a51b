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
    filasofia::Vec3 middle = {}; ///< [m] the point at which forceps take it; a myoma's middle
    std::string problem = {};    ///< why it cannot be treated; empty if it can
};

/// [m] The axis of the scope always passes through this point, because the canal guides it.
inline constexpr filasofia::Vec3 kFulcrum = {0.0, 0.024, 0.0};
/// Collision groups. Scope and forceps never collide with each other.
enum Group { ScopeWall, ForcepsWall, ScopePolyp, ForcepsPolyp, PolypWall, LoopWall, LoopMyoma };

inline const std::vector<std::string> kCases = {"small", "medium", "lobed", "resection"};
/// The patient of a case and a seed, always the same. Throws Error if there is no such case.
Patient makePatient(const std::string& caseName, std::uint64_t seed);

/// What a case file may change of a polyp.
struct PolypRules {
    double polypModulus = 8e3;  ///< [Pa]
    double polypStrength = 9e3; ///< [Pa]
};
constexpr auto fields(const PolypRules*)
{
    using namespace filasofia;
    return describe(
        "PolypRules",
        field("polypModulus", &PolypRules::polypModulus, "Pa", closed(1e3, 1e5), "Young's modulus of the polyp"),
        field("polypStrength", &PolypRules::polypStrength, "Pa", closed(1e3, 1e6), "stress at which the polyp tears"));
}

/// What a case file may change of a myoma and its resection.
struct MyomaRules {
    double myomaModulus = 30e3; ///< [Pa]
    double left = 0.35;         ///< [-]
    double tooDeep = 1e-3;      ///< [m]
};
constexpr auto fields(const MyomaRules*)
{
    using namespace filasofia;
    return describe(
        "MyomaRules",
        field("myomaModulus", &MyomaRules::myomaModulus, "Pa", closed(1e3, 1e6), "Young's modulus of the myoma"),
        field("left", &MyomaRules::left, "-", closed(0.15, 0.9), "share above the wall that may be left"),
        field("tooDeep", &MyomaRules::tooDeep, "m", closed(0, 0.01), "depth in the wall that is a mistake"));
}

struct Bodies {
    filasofia::BodyId uterus = {};
    filasofia::BodyId polyp = {}; ///< or the myoma
};
Bodies addPatient(filasofia::Simulation& sim, const Patient& patient, const filasofia::Training& training);

} // namespace hysteroscopy
