#include "filasofia/engine/build/build_rigid.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/articulation/def_tree.h"
#include "filasofia/engine/articulation/link_motion.h"
#include "filasofia/engine/body/check_collision.h"
#include "filasofia/engine/body/check_size.h"
#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr double kBesideTip = 10.0; // radii by which a needle's tip may lie outside the box of its collision mesh

void buildArticulation(const physics::RigidBodyDef& def, RigidModel& model)
{
    ArticulationModel& out = model.articulation;
    out.tree = treeOf(def.articulation);
    out.commands = startCommands(def.articulation);
    out.to = def.articulation.to;
    out.toElement = def.articulation.toElement;
    out.offset = physics::unitPose(def.articulation.offset, "offset");
    model.inertias = physics::linkInertias(def);
    model.rest.resize(model.inertias.size());
    std::vector<double> starts;
    for (const LinkJoint& joint : out.tree.joints) starts.push_back(joint.start);
    placeLinks(out.tree, starts, model.rest);
}

/// A tip beside its collision mesh would be moved by tissue that it does not touch.
void checkTip(const physics::RigidBodyDef& def, std::span<const CollisionModel> collision)
{
    geometry::Box box;
    for (const CollisionModel& each : collision)
        if (each.element == def.needle->element) box = merged(box, geometry::boxAround(each.shape->rest));
    box = geometry::grown(box, kBesideTip * def.needle->radius);
    if (const Vec3 tip = def.needle->line.front(); !contains(box, tip))
        fail("rigid body '", def.name, "': needle.line[0], the tip, must lie at the element's collision mesh, from (",
             box.low.x, " ", box.low.y, " ", box.low.z, ") to (", box.high.x, " ", box.high.y, " ", box.high.z,
             ") m, got (", tip.x, " ", tip.y, " ", tip.z, ") m");
}

} // namespace

std::unique_ptr<physics::BuiltBody> buildRigid(const physics::RigidBodyDef& def)
{
    const physics::RigidInertia inertia = physics::inertiaOf(def);
    auto built = std::make_unique<BuiltRigidBody>();
    RigidModel& model = built->body.model;
    model.name = def.name;
    for (std::size_t e = 0; e < def.elements.size(); ++e)
        model.rest.push_back(
            physics::unitPose(def.elements[e], text("rigid body '", def.name, "': elements[", e, "]")));
    model.inertias.assign(model.rest.size(), inertia);
    if (!def.articulation.joints.empty()) buildArticulation(def, model);
    model.dynamic = def.dynamic;
    model.gravity = def.gravity;
    model.linearDamping = def.linearDamping;
    model.angularDamping = def.angularDamping;
    model.friction = def.friction;
    model.collision = buildCollision(def);
    model.surface = physics::loadMesh(def.mesh, text("rigid body '", def.name, "': mesh"));
    if (def.needle) {
        checkTip(def, model.collision);
        model.needle = Needle{static_cast<std::size_t>(def.needle->element), def.needle->radius, def.needle->spacing,
                              def.needle->line};
    }
    model.startVelocity = def.velocity;
    model.startAngularVelocity = def.angularVelocity;
    built->body.state = stateAtStart(model);
    check(model, built->body.state);
    return built;
}

} // namespace filasofia::engine
