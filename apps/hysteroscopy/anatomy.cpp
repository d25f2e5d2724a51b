#include "apps/hysteroscopy/anatomy.h"

#include <filasofia/core/word.h>

#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <random>

using namespace filasofia;

namespace hysteroscopy {
namespace {

const std::string kFolder = "meshes/hysteroscopy/";

// Which polyps a case has.
const std::map<std::string, std::vector<std::string>> kCases = {
    {"lobed", {"polyp_lobed_13"}}, {"medium", {"polyp_pedunculated_12"}}, {"small", {"polyp_pedunculated_8"}}};

nlohmann::json read(const std::string& name)
{
    const std::string file = asset(kFolder + name);
    try {
        return nlohmann::json::parse(std::ifstream(file));
    } catch (const nlohmann::json::exception& problem) {
        fail(file, ": ", problem.what());
    }
}

Vec3 vec(const nlohmann::json& json) { return {json.at(0), json.at(1), json.at(2)}; }

std::vector<Polyp> polypsOf(const std::string& caseName)
{
    const auto found = kCases.find(caseName);
    if (found == kCases.end()) fail("hysteroscopy: --case must be small, medium or lobed, got ", shownWord(caseName));
    std::vector<Polyp> polyps;
    const nlohmann::json all = read("polyps.json");
    for (const auto& each : all.at("polyps"))
        if (std::ranges::find(found->second, each.at("name").get<std::string>()) != found->second.end())
            polyps.push_back({each.at("name"), each.at("height"), each.at("width"), each.at("base")});
    if (polyps.empty()) fail("hysteroscopy: polyps.json has no polyp for the case ", caseName);
    return polyps;
}

/// Half the cavity's width and depth [m] around its axis, at heights that ascend.
struct Level {
    double y, width, depth;
};

/// How far out a point is, relative to the wall: below 1 it is in the hollow.
double outwards(const std::vector<Level>& levels, Vec3 p)
{
    const auto next = std::ranges::lower_bound(levels, p.y, {}, &Level::y);
    if (next == levels.begin() || next == levels.end()) return 2.0;
    const Level &a = *(next - 1), &b = *next;
    const double t = (p.y - a.y) / (b.y - a.y);
    return std::hypot(p.x / (a.width + t * (b.width - a.width)), p.z / (a.depth + t * (b.depth - a.depth)));
}

/// Nobody could treat a polyp that does not fit, or that a straight instrument from the canal cannot get at.
std::string problemOf(const Patient& patient, const std::vector<Level>& levels)
{
    if (patient.site.free < patient.polyp.height + 0.5_mm) return "it touches the wall opposite";
    if (outwards(levels, patient.middle) >= 1.0) return "its head is inside the wall";
    const Vec3 way = patient.middle - kFulcrum;
    if (std::acos(normalized(way).y) > 30_deg) return "it lies too far aside";
    for (double t = 0.2; t < 1.0; t += 0.05)
        if (outwards(levels, kFulcrum + t * way) >= 1.0) return "the wall is in the way";
    return {};
}

} // namespace

std::vector<std::string> cases()
{
    std::vector<std::string> names;
    for (const auto& [name, polyps] : kCases) names.push_back(name);
    return names;
}

Patient makePatient(const std::string& caseName, std::uint64_t seed)
{
    const std::vector<Polyp> polyps = polypsOf(caseName);
    const nlohmann::json uterus = read("uterus.json");
    std::vector<Level> levels;
    for (const auto& each : uterus.at("centreline"))
        levels.push_back({each.at("at").at(1), each.at("halfWidth"), each.at("halfDepth")});
    // Sites are tried until one suits; what mt19937_64 gives is the same everywhere.
    std::mt19937_64 random(seed);
    Patient patient;
    for (int attempt = 0; attempt < 200; ++attempt) {
        const auto& site = uterus.at("sites").at(random() % uterus.at("sites").size());
        patient.polyp = polyps[random() % polyps.size()];
        patient.site = {vec(site.at("at")), normalized(vec(site.at("normal"))), site.at("free")};
        // +Y goes to the normal, after a turn about itself.
        const Vec3 up = {0, 1, 0}, axis = cross(up, patient.site.normal);
        const Quat lean = axisAngle(axis, std::atan2(length(axis), dot(up, patient.site.normal)));
        patient.pose = {patient.site.at, lean * axisAngle(up, 1_deg * static_cast<double>(random() % 360))};
        patient.middle = patient.site.at + (patient.polyp.height - 0.5 * patient.polyp.width) * patient.site.normal;
        patient.problem = problemOf(patient, levels);
        if (patient.problem.empty()) break;
    }
    return patient;
}

Bodies addPatient(Simulation& sim, const Patient& patient)
{
    SoftBodyDef uterus{.name = "uterus", .mesh = asset(kFolder + "uterus_1702.msh")};
    uterus.material = FemMaterial{.youngModulus = 12_kPa, .poissonRatio = 0.42};
    uterus.rayleigh = {.mass = 5.0, .stiffness = 0.02};
    uterus.collision = {{.proximity = 0.2_mm}};
    uterus.friction = 0.05;
    // Ligaments hold the cervix and the horns.
    for (const Box& held : {Box{{-1, 2_mm, 9_mm}, {1, 26_mm, 1}}, Box{{-1, 2_mm, -1}, {1, 26_mm, -9_mm}},
                            Box{{9_mm, 2_mm, -1}, {1, 26_mm, 1}}, Box{{-1, 2_mm, -1}, {-9_mm, 26_mm, 1}},
                            Box{{20_mm, 40_mm, -1}, {1, 1, 1}}, Box{{-1, 40_mm, -1}, {-20_mm, 1, 1}}})
        uterus.attachments.push_back({.box = held, .stiffness = 100.0});
    Bodies bodies;
    bodies.uterus = sim.add(uterus);
    sim.show(bodies.uterus, {.surface = asset(kFolder + "uterus.obj"), .material = MucosaMaterial{.noiseScale = 600}});

    SoftBodyDef polyp{.name = "polyp", .mesh = asset(kFolder + patient.polyp.name + ".msh"), .pose = patient.pose};
    polyp.material = FemMaterial{.youngModulus = 8_kPa, .poissonRatio = 0.4, .tearingThreshold = 9_kPa};
    polyp.rayleigh = {.mass = 10.0, .stiffness = 0.02};
    polyp.collision = {{.proximity = 0.1_mm, .group = 1}};
    polyp.friction = 0.8;
    polyp.dynamicTopology = true;
    polyp.attachments = {{.nodes = patient.polyp.base, .to = bodies.uterus}};
    bodies.polyp = sim.add(polyp);
    sim.show(bodies.polyp, {.subdivision = 1,
                            .material = MucosaMaterial{.baseColor = {0.72, 0.30, 0.24}, .noiseScale = 600},
                            .interior = TissueMaterial{.baseColor = {0.42, 0.02, 0.015}, .wetness = 1}});
    return bodies;
}

} // namespace hysteroscopy
