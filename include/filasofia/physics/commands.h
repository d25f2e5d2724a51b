#pragma once

#include "filasofia/physics/defs.h"

#include "filasofia/core/body_id.h"

#include <functional>

/// The only way into a running simulation: applied at the start of the next step, in the order of posting.
namespace filasofia::physics {

class PhysicsEngine;

/// A finished body, as its engine keeps it: built and checked on the caller's thread, moved in at a step's start.
class BuiltBody {
public:
    virtual ~BuiltBody() = default;
    [[nodiscard]] virtual int nodeCount() const = 0; ///< nodes of a soft body, elements of a rigid one
};

struct AddBody {
    BodyId id = {};
    std::shared_ptr<const BodyDef> def = {};
    std::unique_ptr<BuiltBody> body = {};
};
struct RemoveBody {
    BodyId id = {};
};
/// Where a rigid element is from the next step on.
struct SetPose {
    BodyId id = {};
    int element = 0;
    Pose pose = {};
};
struct SetGravity {
    Vec3 gravity = {}; ///< [m/s^2]
};
struct SetMaterial {
    BodyId id = {};
    SoftMaterial material = {};
};
/// Replaces all given forces of a soft body.
struct SetForces {
    BodyId id = {};
    std::vector<NodalForce> forces = {};
};
struct SetPressure {
    BodyId id = {};
    double pressure = 0.0; ///< [Pa]
};
/// Every body back to where it was added, at rest; time and step count go on.
struct Reset {};
/// While paused, steps apply commands and nothing moves.
struct Pause {
    bool paused = true;
};
/// Runs once between two steps with the engine itself in hand; see filasofia/engine/native.h.
struct Tune {
    std::function<void(PhysicsEngine&)> change;
};

// For recordings: what a command says. The built body is no part of it: it is built again from the Def.
constexpr auto fields(const AddBody*)
{
    return describe("AddBody", field("id", &AddBody::id, "the body to be"),
                    field("def", &AddBody::def, "what it is made from"));
}
constexpr auto fields(const RemoveBody*) { return describe("RemoveBody", field("id", &RemoveBody::id, "the body")); }
constexpr auto fields(const SetPose*)
{
    return describe("SetPose", field("id", &SetPose::id, "the rigid body"),
                    field("element", &SetPose::element, "-", nonNegative(), "of its elements"),
                    field("pose", &SetPose::pose, "where it is from now on"));
}
constexpr auto fields(const SetGravity*)
{
    return describe("SetGravity", field("gravity", &SetGravity::gravity, "m/s^2", finite(), "acts on every body"));
}
constexpr auto fields(const SetMaterial*)
{
    return describe("SetMaterial", field("id", &SetMaterial::id, "the soft body"),
                    field("material", &SetMaterial::material, "of the kind it was made with"));
}
constexpr auto fields(const SetForces*)
{
    return describe("SetForces", field("id", &SetForces::id, "the soft body"),
                    field("forces", &SetForces::forces, "in place of those it had"));
}
constexpr auto fields(const SetPressure*)
{
    return describe("SetPressure", field("id", &SetPressure::id, "the soft body"),
                    field("pressure", &SetPressure::pressure, "Pa", finite(), "positive pushes inwards"));
}
constexpr auto fields(const Reset*) { return describe("Reset"); }
constexpr auto fields(const Pause*) { return describe("Pause", field("paused", &Pause::paused, "or going on")); }
constexpr auto fields(const Tune*) { return describe("Tune"); } // a function cannot be written down

using Command =
    std::variant<AddBody, RemoveBody, SetPose, SetGravity, SetMaterial, SetForces, SetPressure, Reset, Pause, Tune>;

} // namespace filasofia::physics
