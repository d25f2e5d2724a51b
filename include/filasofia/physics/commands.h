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

using Command =
    std::variant<AddBody, RemoveBody, SetPose, SetGravity, SetMaterial, SetForces, SetPressure, Reset, Pause, Tune>;

} // namespace filasofia::physics
