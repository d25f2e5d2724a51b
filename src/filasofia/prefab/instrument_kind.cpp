#include "filasofia/prefab/instrument_kind.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"

#include <algorithm>

namespace filasofia::prefab {
namespace {

/// What comes with Filasofia of a kind (assets/meshes/*/instruments.json).
struct Kind {
    std::string_view folder, name, shaft;
    double opensBy;                               ///< [rad]
    double closingTorque;                         ///< [N m]
    std::optional<std::array<Vec3, 2>> edge = {}; ///< the upper blade
};

Kind kindOf(InstrumentKind kind)
{
    using Edge = std::array<Vec3, 2>;
    constexpr double degree = std::numbers::pi / 180.0;
    switch (kind) {
    case InstrumentKind::Forceps:
        return {"hysteroscopy", "forceps", "tool_shaft", 45.0 * degree, 0.5e-3};
    case InstrumentKind::Grasper:
        return {"hysteroscopy", "grasper", "tool_shaft", 40.0 * degree, 0.5e-3};
    case InstrumentKind::Scissors:
        return {"hysteroscopy", "scissors", "tool_shaft",
                35.0 * degree,  0.5e-3,     Edge{Vec3{0.0, -0.06e-3, -1e-3}, Vec3{0.0, -0.06e-3, -6.4e-3}}};
    case InstrumentKind::NeedleDriver:
        return {"suturing", "needle_driver", "shaft", 35.0 * degree, 0.15};
    case InstrumentKind::PickUps:
        return {"suturing", "pick_ups", "shaft", 35.0 * degree, 10e-3};
    case InstrumentKind::SutureScissors:
        return {"suturing", "suture_scissors",
                "shaft",    35.0 * degree,
                50e-3,      Edge{Vec3{0.0, -0.18e-3, -3e-3}, Vec3{0.0, -0.18e-3, -14.34e-3}}};
    case InstrumentKind::LaparoscopicGrasper:
        return {"laparoscopy", "grasper", "shaft", 40.0 * degree, 30e-3};
    case InstrumentKind::Dissector:
        return {"laparoscopy", "dissector", "shaft", 40.0 * degree, 20e-3};
    case InstrumentKind::ClipApplier:
        return {"laparoscopy", "clip_applier", "shaft", 12.0 * degree, 50e-3};
    case InstrumentKind::SpecimenBag:
        return {"laparoscopy", "specimen_bag", "shaft", 30.0 * degree, 50e-3};
    case InstrumentKind::UltrasonicShears:
        return {"laparoscopy", "ultrasonic_shears", "shaft", 35.0 * degree, 0.1};
    case InstrumentKind::Hook:
        return {"laparoscopy", "hook", "shaft", 0.0, 1.0};
    case InstrumentKind::SuctionIrrigator:
        return {"laparoscopy", "suction_irrigator", "shaft", 0.0, 1.0};
    case InstrumentKind::LaparoscopicScissors:
        break;
    }
    return {"laparoscopy", "scissors", "shaft",
            35.0 * degree, 50e-3,      Edge{Vec3{0.0, -0.18e-3, -3e-3}, Vec3{0.0, -0.18e-3, -19.2e-3}}};
}

std::string part(std::string_view folder, std::string_view name)
{
    return runtime::asset(text("meshes/", folder, "/", name, ".obj"));
}
/// All instruments of 5 mm have the shaft of suturing.
std::string_view shaftFolder(const Kind& kind) { return kind.folder == "laparoscopy" ? "suturing" : kind.folder; }

/// A box from -z to the pivot; its flat face lies in the plane between the jaws, above it or below.
std::shared_ptr<const geometry::TriangleMesh> bar(double width, double height, double length, bool above)
{
    geometry::TriangleMesh mesh = *geometry::shapes::box({width, height, length});
    for (Vec3& each : mesh.vertices) each += Vec3{0.0, (above ? 0.5 : -0.5) * height, -0.5 * length};
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

/// A pad that moves, and a blade that does not.
std::vector<JawDef> shears()
{
    const auto pad = bar(2.4e-3, 1.3e-3, 14.5e-3, true), blade = bar(1.5e-3, 1.5e-3, 15e-3, false);
    return {{.surface = pad, .collision = pad, .axis = {1.0, 0.0, 0.0}, .opensBy = 35.0 * std::numbers::pi / 180.0},
            {.surface = blade, .collision = blade, .axis = {-1.0, 0.0, 0.0}, .opensBy = 0.0}};
}

/// An L of wire, whose upright cuts.
JawDef hook()
{
    using geometry::shapes::tube;
    return {.surface = tube({{}, {0, 0, -14e-3}, {0, -1.2e-3, -15e-3}, {0, -3e-3, -15e-3}}, 0.7e-3, 12),
            .opensBy = 0.0,
            .edge = std::array{Vec3{0, 0, -8e-3}, Vec3{0, 0, -15e-3}}};
}

/// A tube whose mouth and side holes are dark rings.
JawDef suctionTube()
{
    constexpr double outer = 2.6e-3, inner = 1.9e-3, back = 12e-3;        // over the shaft's fork
    std::vector<Vec3> outline = {{inner, -29e-3, 0}, {outer, -30e-3, 0}}; // along y: from the mouth to the pivot
    for (const double hole : {-27e-3, -25e-3, -23e-3}) {
        outline.push_back({outer, hole - 0.5e-3, 0});
        outline.push_back({inner, hole, 0});
        outline.push_back({outer, hole + 0.5e-3, 0});
    }
    outline.push_back({outer, back, 0});
    outline.push_back({inner, back, 0});
    geometry::TriangleMesh mesh = *geometry::shapes::revolved(outline, 24);
    for (Vec3& each : mesh.vertices) each = {each.x, -each.z, each.y};
    return {.surface = std::make_shared<const geometry::TriangleMesh>(std::move(mesh)),
            .collision = geometry::shapes::tube({{0, 0, 1e-3}, {0, 0, -30e-3}}, outer, 12),
            .opensBy = 0.0};
}

std::vector<JawDef> jawsOf(const Kind& kind)
{
    if (kind.name == "ultrasonic_shears") return shears();
    if (kind.name == "hook") return {hook()};
    if (kind.name == "suction_irrigator") return {suctionTube()};
    std::vector<JawDef> jaws;
    const bool drawnHere = kind.name == "clip_applier" || kind.name == "specimen_bag";
    for (const bool upper : {true, false}) {
        const std::string_view side = upper ? "upper" : "lower";
        JawDef jaw{.axis = {upper ? 1.0 : -1.0, 0.0, 0.0}, .opensBy = kind.opensBy};
        if (drawnHere) { // two bars, or two wires; they touch nothing
            const double side2 = upper ? 1.0 : -1.0;
            if (kind.name == "specimen_bag")
                jaw.surface = geometry::shapes::tube({{0, 0, 1e-3}, {0, 0, -65e-3}}, 0.6e-3, 12);
            else
                jaw.surface = geometry::shapes::tube({{0, side2 * 0.5e-3, 1e-3},
                                                      {0, side2 * 1.7e-3, -4e-3},
                                                      {0, side2 * 1.1e-3, -9e-3},
                                                      {0, side2 * 0.9e-3, -13.5e-3}},
                                                     0.75e-3, 12);
            jaws.push_back(jaw);
            continue;
        }
        const std::string name = text(kind.name, kind.edge ? "_blade_" : "_jaw_", side);
        jaw.surface = part(kind.folder, name);
        // A collision mesh of a blade would push away what its edge has to cut, so only the edge touches tissue. The
        // lower blade is the upper one, turned about the shaft.
        if (kind.edge) {
            jaw.edge = kind.edge;
            if (!upper)
                for (Vec3& end : *jaw.edge) end = {-end.x, -end.y, end.z};
        } else {
            jaw.collision = part(kind.folder, text(name, "_collision"));
        }
        jaws.push_back(jaw);
    }
    return jaws;
}

} // namespace

bool isEmpty(const physics::TriangleMeshSource& source)
{
    const auto* file = std::get_if<std::string>(&source);
    return file != nullptr && file->empty();
}

ArticulatedInstrumentDef completed(ArticulatedInstrumentDef def)
{
    const std::string object = text("instrument '", def.name, "'");
    validate(def, object);
    def.pose = physics::unitPose(def.pose, text(object, ": pose"));
    const Kind kind = kindOf(def.kind);
    if (def.jaws.empty()) def.jaws = jawsOf(kind);
    if (def.jaws.size() > 2) fail(object, ": jaws must have one or two entries, got ", def.jaws.size());
    const bool moves = std::ranges::any_of(def.jaws, [](const JawDef& jaw) { return jaw.opensBy > 0.0; });
    if (!moves && hasJaws(def.kind)) fail(object, ": jaws: at least one must have opensBy > 0 rad, got none");
    for (std::size_t i = 0; i < def.jaws.size(); ++i) {
        if (length(def.jaws[i].axis) == 0.0) fail(object, ": jaws[", i, "].axis must have a length > 0, got 0 0 0");
        if (const auto& edge = def.jaws[i].edge; edge && distance((*edge)[0], (*edge)[1]) == 0.0)
            fail(object, ": jaws[", i, "].edge must have a length > 0 m, got 0");
    }
    if (isEmpty(def.shaft)) def.shaft = part(shaftFolder(kind), kind.shaft);
    if (isEmpty(def.shaftCollision)) def.shaftCollision = part(shaftFolder(kind), text(kind.shaft, "_collision"));
    if (!def.closingTorque) def.closingTorque = kind.closingTorque;
    if (kind.edge || def.kind == InstrumentKind::ClipApplier || def.kind == InstrumentKind::SpecimenBag || !moves)
        def.grasps = false;
    return def;
}

} // namespace filasofia::prefab
