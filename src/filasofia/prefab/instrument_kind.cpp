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

std::vector<JawDef> jawsOf(const Kind& kind)
{
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
    if (std::ranges::none_of(def.jaws, [](const JawDef& jaw) { return jaw.opensBy > 0.0; }))
        fail(object, ": jaws: at least one must have opensBy > 0 rad, got none");
    for (std::size_t i = 0; i < def.jaws.size(); ++i) {
        if (length(def.jaws[i].axis) == 0.0) fail(object, ": jaws[", i, "].axis must have a length > 0, got 0 0 0");
        if (const auto& edge = def.jaws[i].edge; edge && distance((*edge)[0], (*edge)[1]) == 0.0)
            fail(object, ": jaws[", i, "].edge must have a length > 0 m, got 0");
    }
    if (isEmpty(def.shaft)) def.shaft = part(shaftFolder(kind), kind.shaft);
    if (isEmpty(def.shaftCollision)) def.shaftCollision = part(shaftFolder(kind), text(kind.shaft, "_collision"));
    if (!def.closingTorque) def.closingTorque = kind.closingTorque;
    if (kind.edge || def.kind == InstrumentKind::ClipApplier || def.kind == InstrumentKind::SpecimenBag)
        def.grasps = false;
    return def;
}

} // namespace filasofia::prefab
