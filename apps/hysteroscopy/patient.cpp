#include "apps/hysteroscopy/patient.h"

#include "apps/hysteroscopy/theatre.h"

#include <filasofia/core/random.h>
#include <filasofia/core/user_file.h>
#include <filasofia/core/word.h>
#include <filasofia/geometry/surface.h>

#include <nlohmann/json.hpp>

#include <array>
#include <map>
#include <span>

using namespace filasofia;

namespace hysteroscopy {
namespace {

const std::string kFolder = "meshes/hysteroscopy/";
const std::vector<std::string> kPolyps = {"polyp_pedunculated_8", "polyp_pedunculated_12", "polyp_lobed_13",
                                          "myoma_11"};

nlohmann::json read(const std::string& name)
{
    const std::string file = asset(kFolder + name);
    try {
        return nlohmann::json::parse(readFile(file, file));
    } catch (const nlohmann::json::exception& problem) {
        fail(file, ": ", problem.what());
    }
}

Vec3 vec(const nlohmann::json& json) { return {json.at(0), json.at(1), json.at(2)}; }

/// [-] Distance of a point from the cavity's axis relative to the wall's distance; below 1 the point is in the cavity.
double outwards(const nlohmann::json& axis, Vec3 p)
{
    for (std::size_t i = 1; i < axis.size(); ++i) {
        const Vec3 a = vec(axis[i - 1].at("at")), b = vec(axis[i].at("at"));
        if (p.y < a.y || p.y > b.y) continue;
        const auto mixed = [&, t = (p.y - a.y) / (b.y - a.y)](const char* what) {
            return (1.0 - t) * axis[i - 1].at(what).get<double>() + t * axis[i].at(what).get<double>();
        };
        return std::hypot(p.x / mixed("halfWidth"), p.z / mixed("halfDepth"));
    }
    return 2.0;
}

/// Rejects a polyp that does not fit, or that a straight instrument in the canal cannot reach.
std::string problemOf(const Patient& patient, const nlohmann::json& axis)
{
    if (patient.free < patient.height + 0.5_mm) return "it touches the opposite wall";
    if (outwards(axis, patient.middle) >= 1.0) return "its head is inside the wall";
    const Vec3 way = patient.middle - kFulcrum;
    if (std::acos(normalized(way).y) > 30_deg) return "it lies too far to the side";
    for (double t = 0.2; t < 1.0; t += 0.05)
        if (outwards(axis, kFulcrum + t * way) >= 1.0) return "the wall is in the way";
    return {};
}

using Corners = std::array<Vec3, 3>;

/// Triangles that share corners at the same place.
struct Patch {
    TriangleMesh mesh = {};
    std::map<std::array<double, 3>, int> number = {};
    void add(const Corners& at)
    {
        geometry::Triangle triangle = {};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [found, fresh] =
                number.try_emplace({at[k].x, at[k].y, at[k].z}, static_cast<int>(mesh.vertices.size()));
            if (fresh) mesh.vertices.push_back(at[k]);
            triangle[k] = found->second;
        }
        mesh.triangles.push_back(triangle);
    }
};

/// Adds a triangle, or those of its quarters and their quarters that are farther than `far` [m] from all points.
void addAwayFrom(std::span<const Vec3> points, double far, const Corners& at, int quarters, Patch& out)
{
    const auto isNear = [&](Vec3 place) {
        return std::ranges::any_of(points, [&](Vec3 point) { return distance(place, point) < far; });
    };
    const Corners half = {0.5 * (at[0] + at[1]), 0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0])};
    const bool part = std::ranges::any_of(at, isNear) || std::ranges::any_of(half, isNear);
    if (part && quarters > 0) {
        for (const Corners& each : {Corners{at[0], half[0], half[2]}, Corners{half[0], at[1], half[1]},
                                    Corners{half[2], half[1], at[2]}, half})
            addAwayFrom(points, far, each, quarters - 1, out);
    } else if (!part)
        out.add(at);
}

/// [m] The height above which the cavity is wide enough for the polyp and what holds it; infinite: nowhere.
double wideFrom(const nlohmann::json& axis, double width)
{
    constexpr double kPlay = 1.5_mm;
    for (const auto& each : axis)
        if (each.at("at").at(1) > kFulcrum.y &&
            std::min(each.at("halfWidth").get<double>(), each.at("halfDepth").get<double>()) > 0.5 * width + kPlay)
            return each.at("at").at(1);
    return std::numeric_limits<double>::infinity();
}

/// The wall that a polyp may touch. Not what it lies in or on at the start: springs hold its foot there, against which
/// contacts would push without end. Nor the canal, in which what is wider than it would be torn apart.
std::shared_ptr<const TriangleMesh> wallBeside(const Patient& patient)
{
    constexpr double kBeside = 2_mm;
    std::vector<Vec3> polyp = loadTetMesh(asset(kFolder + patient.polyp + ".msh")).nodes;
    for (Vec3& node : polyp) node = transform(patient.pose, node);
    const TriangleMesh all = geometry::extractSurface(loadTetMesh(asset(kFolder + "uterus_1702.msh"))).mesh;
    Patch out;
    for (const auto& [a, b, c] : all.triangles) {
        const auto at = [&](int corner) { return all.vertices[static_cast<std::size_t>(corner)]; };
        if (std::min({at(a).y, at(b).y, at(c).y}) >= patient.wideFrom)
            addAwayFrom(polyp, kBeside, {at(a), at(b), at(c)}, 3, out);
    }
    return std::make_shared<const TriangleMesh>(std::move(out.mesh));
}

/// What the scope comes through: the upper end of the vagina, into which the cervix protrudes. It is drawn only.
void addVault(Simulation& sim)
{
    TriangleMesh vault = *shapes::ellipsoid({20_mm, 38_mm, 20_mm}, 24);
    for (Vec3& at : vault.vertices) { // its folds run around it
        const double fold = 0.04 * std::sin(700 * at.y + 1.5 * std::sin(3.0 * std::atan2(at.z, at.x)));
        at = {at.x * (1.0 + fold), at.y, at.z * (1.0 + fold)};
    }
    // Where the cervix is, it is open.
    std::erase_if(vault.triangles, [&](const geometry::Triangle& corners) {
        return std::ranges::any_of(corners,
                                   [&](int i) { return vault.vertices[static_cast<std::size_t>(i)].y > 33_mm; });
    });
    for (auto& triangle : vault.triangles) std::swap(triangle[1], triangle[2]); // it is seen from inside
    RigidBodyDef def{.name = "vagina", .mesh = std::make_shared<const TriangleMesh>(std::move(vault))};
    def.elements = {{{0, -30_mm, 0}, {}}};
    const BodyId vagina = sim.add(def);
    sim.show(vagina, {.material = MucosaMaterial{.baseColor = {0.70, 0.27, 0.23}, .noiseScale = 500, .vessels = 0.3}});
}

/// Places what grows there at a site, rotated about the wall's normal.
void place(Patient& patient, const nlohmann::json& site, double turned)
{
    patient.normal = normalized(vec(site.at("normal")));
    patient.free = site.at("free");
    // Rotates +Y onto the normal, after a rotation about +Y itself.
    const Vec3 up = {0, 1, 0}, across = cross(up, patient.normal);
    const Quat lean = axisAngle(across, std::atan2(length(across), dot(up, patient.normal)));
    patient.pose = {vec(site.at("at")), lean * axisAngle(up, turned)};
}

/// Reads the size and the base, and returns the rest of what is known of it.
nlohmann::json describe(Patient& patient, const std::string& file, const std::string& list)
{
    const nlohmann::json whole = read(file);
    for (const auto& each : whole.at(list))
        if (each.at("name") == patient.polyp) {
            patient.height = each.at("height");
            patient.width = each.at("width");
            patient.base = each.at("base").get<std::vector<int>>();
            return each;
        }
    fail(file, ": has no ", patient.polyp);
}

/// A myoma lies at one of the places that a straight loop can come along.
Patient makeMyoma(Patient patient, std::uint64_t seed)
{
    patient.kind = Patient::Kind::Myoma;
    const nlohmann::json sites = describe(patient, "myomas.json", "myomas").at("sites");
    Random random(seed);
    const int chosen = sites.at(static_cast<std::size_t>(random.below(static_cast<int>(sites.size()))));
    place(patient, read("uterus.json").at("sites").at(static_cast<std::size_t>(chosen)), 1_deg * random.below(360));
    patient.middle = patient.pose.position + 0.5 * patient.height * patient.normal;
    patient.wideFrom = std::numeric_limits<double>::infinity();
    if (patient.free < patient.height + 5.5_mm) patient.problem = "the scope has no place above it";
    return patient;
}

} // namespace

Patient makePatient(const std::string& caseName, std::uint64_t seed)
{
    const auto chosen = std::ranges::find(kCases, caseName) - kCases.begin();
    if (chosen == std::ssize(kCases)) fail("hysteroscopy: unknown case ", shownWord(caseName));
    Patient patient{.polyp = kPolyps[static_cast<std::size_t>(chosen)]};
    if (caseName == "resection") return makeMyoma(patient, seed);
    const nlohmann::json uterus = read("uterus.json");
    describe(patient, "polyps.json", "polyps");
    patient.wideFrom = wideFrom(uterus.at("centreline"), patient.width);
    // Tries sites until one suits.
    Random random(seed);
    for (int attempt = 0; attempt < 200; ++attempt) {
        const auto& site =
            uterus.at("sites").at(static_cast<std::size_t>(random.below(static_cast<int>(uterus.at("sites").size()))));
        place(patient, site, 1_deg * static_cast<double>(random.below(360)));
        // Forceps take the polyp by its head or, if the jaws do not reach around the head, by its neck.
        const double above = patient.width < 6_mm ? patient.height - 0.5 * patient.width : 0.4 * patient.height;
        patient.middle = patient.pose.position + above * patient.normal;
        patient.problem = problemOf(patient, uterus.at("centreline"));
        if (patient.problem.empty()) break;
    }
    return patient;
}

namespace {

/// Firmer than the wall, and without a stalk.
BodyId addMyoma(Simulation& sim, const Patient& patient, BodyId uterus, double modulus)
{
    SoftBodyDef def{.name = "myoma", .mesh = asset(kFolder + patient.polyp + ".msh"), .pose = patient.pose};
    def.material = FemMaterial{.youngModulus = modulus, .poissonRatio = 0.42};
    def.rayleigh = {.mass = 10.0, .stiffness = 0.02};
    def.solver = ConjugateGradient{.tolerance = 2e-2, .minIterations = 60};
    // Chips float away through each other.
    def.collision = {{.proximity = 0.1_mm, .group = ScopePolyp, .selfOnceCut = false},
                     {.proximity = 0.1_mm, .group = LoopMyoma, .selfOnceCut = false}};
    def.friction = 0.2;
    def.dynamicTopology = true;
    def.attachments = {{.nodes = patient.base, .stiffness = 40.0, .to = uterus}};
    const BodyId myoma = sim.add(def);
    sim.show(myoma, {.subdivision = 1,
                     .material = MucosaMaterial{.baseColor = {0.76, 0.40, 0.34}, .noiseScale = 700, .vessels = 0.5},
                     .interior = TissueMaterial{.baseColor = {0.80, 0.62, 0.54}, .wetness = 1}});
    return myoma;
}

} // namespace

Bodies addPatient(Simulation& sim, const Patient& patient, const Training& training)
{
    SoftBodyDef uterus{.name = "uterus", .mesh = asset(kFolder + "uterus_1702.msh")};
    const double modulus = training.rules(kRules[training.difficulty]).uterusModulus;
    uterus.material = FemMaterial{.youngModulus = modulus, .poissonRatio = 0.42};
    uterus.rayleigh = {.mass = 5.0, .stiffness = 0.02};
    uterus.solver = ConjugateGradient{.tolerance = 2e-2, .minIterations = 60};
    const bool myoma = patient.kind == Patient::Kind::Myoma;
    uterus.collision = {{.proximity = 0.2_mm, .group = ScopeWall},
                        {.proximity = 0.2_mm, .group = myoma ? LoopWall : ForcepsWall}};
    if (myoma) { // a loop cuts what it meets
        uterus.dynamicTopology = true;
        for (CollisionDef& each : uterus.collision) each.selfOnceCut = false;
    }
    const bool touching = std::isfinite(patient.wideFrom);
    if (touching) uterus.collision.push_back({.mesh = wallBeside(patient), .proximity = 0.1_mm, .group = PolypWall});
    uterus.friction = 0.05;
    // Ligaments attach the cervix and the horns.
    for (const Box& ligament : {Box{{-1, 2_mm, 9_mm}, {1, 26_mm, 1}}, Box{{-1, 2_mm, -1}, {1, 26_mm, -9_mm}},
                                Box{{9_mm, 2_mm, -1}, {1, 26_mm, 1}}, Box{{-1, 2_mm, -1}, {-9_mm, 26_mm, 1}},
                                Box{{20_mm, 40_mm, -1}, {1, 1, 1}}, Box{{-1, 40_mm, -1}, {-20_mm, 1, 1}}})
        uterus.attachments.push_back({.box = ligament, .stiffness = 100.0});
    Bodies bodies;
    bodies.uterus = sim.add(uterus);
    const MucosaMaterial lining{.baseColor = {0.62, 0.17, 0.13},
                                .subsurfaceColor = {0.66, 0.10, 0.07},
                                .wetness = 0.95,
                                .noiseScale = 850,
                                .pits = 0.45,
                                .vessels = 0.6,
                                .bump = 0.5};
    addVault(sim);
    sim.show(bodies.uterus, {.surface = asset(kFolder + "uterus.obj"), .material = lining});

    if (myoma) {
        bodies.polyp = addMyoma(sim, patient, bodies.uterus, training.rules(MyomaRules{}).myomaModulus);
        return bodies;
    }
    SoftBodyDef polyp{.name = "polyp", .mesh = asset(kFolder + patient.polyp + ".msh"), .pose = patient.pose};
    const PolypRules rules = training.rules(PolypRules{});
    polyp.material =
        FemMaterial{.youngModulus = rules.polypModulus, .poissonRatio = 0.4, .tearingThreshold = rules.polypStrength};
    polyp.rayleigh = {.mass = 10.0, .stiffness = 0.02};
    polyp.solver = ConjugateGradient{.tolerance = 2e-2, .minIterations = 60};
    polyp.collision = {{.proximity = 0.1_mm, .group = ScopePolyp}, {.proximity = 0.1_mm, .group = ForcepsPolyp}};
    if (touching) polyp.collision.push_back({.proximity = 0.1_mm, .group = PolypWall});
    polyp.friction = 0.8;
    polyp.dynamicTopology = true;
    polyp.attachments = {{.nodes = patient.base, .stiffness = 40.0, .to = bodies.uterus}};
    bodies.polyp = sim.add(polyp);
    sim.show(bodies.polyp, {.subdivision = 1,
                            .material = MucosaMaterial{.baseColor = {0.72, 0.20, 0.16}, .noiseScale = 700},
                            .interior = TissueMaterial{.baseColor = {0.42, 0.02, 0.015}, .wetness = 1}});
    return bodies;
}

} // namespace hysteroscopy
