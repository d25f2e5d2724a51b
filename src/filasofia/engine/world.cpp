#include "filasofia/engine/world.h"

#include "filasofia/core/hash.h"
#include "filasofia/engine/build_body.h"

namespace filasofia::engine {
namespace {

void add(Hasher& hash, Vec3 v)
{
    hash.add(v.x);
    hash.add(v.y);
    hash.add(v.z);
}

void add(Hasher& hash, Quat q)
{
    hash.add(q.w);
    add(hash, Vec3{q.x, q.y, q.z});
}

void add(Hasher& hash, const Pose& pose)
{
    add(hash, pose.position);
    add(hash, pose.orientation);
}

} // namespace

std::unique_ptr<physics::BuiltBody> World::build(const physics::BodyDef& def) const { return buildBody(def); }

physics::StepReport World::step(const physics::StepInput& in)
{
    physics::StepReport report{.dt = in.dt, .flags = in.flags};
    applyCommands(in.commands, *this, model_, state_, systems_, report); // 1 what the outside asked for
    assemble(model_, in.dt, state_, systems_);                           // 3 forces and stiffness
    advance(model_, in.dt, systems_, state_, report);                    // 4 new velocities, new positions
    return report;
}

void World::capture(frame::Frame& out) const
{
    out.step = state_.step;
    out.time = state_.time;
    out.softBodies.resize(model_.softBodies.size());
    for (std::size_t b = 0; b < model_.softBodies.size(); ++b) {
        out.softBodies[b].id = model_.softBodies[b].id;
        out.softBodies[b].positions = state_.softBodies[b].x;
        out.softBodies[b].velocities = state_.softBodies[b].v;
    }
    out.rigidBodies.resize(model_.rigidBodies.size());
    for (std::size_t b = 0; b < model_.rigidBodies.size(); ++b) {
        out.rigidBodies[b].id = model_.rigidBodies[b].id;
        out.rigidBodies[b].poses = state_.rigidBodies[b].poses;
    }
}

void World::record(physics::StepRecord& out) const
{
    out.rigidPoses.clear();
    for (const RigidState& body : state_.rigidBodies)
        out.rigidPoses.insert(out.rigidPoses.end(), body.poses.begin(), body.poses.end());
}

std::uint64_t World::hash() const
{
    Hasher hash;
    hash.add(state_.step);
    hash.add(state_.time);
    add(hash, state_.gravity);
    for (const SoftState& body : state_.softBodies) {
        for (const auto* list : {&body.x, &body.v, &body.dv, &body.forces})
            for (const Vec3& v : *list) add(hash, v);
        for (const Quat& q : body.rotations) add(hash, q);
        hash.add(body.pressure);
    }
    for (const RigidState& body : state_.rigidBodies)
        for (const Pose& pose : body.poses) add(hash, pose);
    return hash.value();
}

} // namespace filasofia::engine
