#include "filasofia/runtime/followers.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/surfaces.h"

namespace filasofia::runtime {
namespace {

void put(visual::Transform& transform, const Pose& at, const Pose& offset)
{
    Pose pose = at * offset;
    pose.orientation = normalized(pose.orientation);
    if (isFinite(pose)) transform.setPose(pose); // what a body that has blown up carries stays where it was
}

mapping::SurfacePoint pointOf(const physics::SoftBodyDef& body, const FollowDef& def, const std::string& object)
{
    const auto mapped = [&](const SurfaceSource& source) {
        const auto surface = loadSurface(source, object);
        return mapSoft(body, surface.get(), object);
    };
    if (const auto* nearest = std::get_if<FollowNearest>(&def.at)) {
        return mapping::nearestPoint(mapped(nearest->surface), transform(body.pose, nearest->place), object);
    }
    const auto* on = std::get_if<FollowTriangle>(&def.at);
    if (!on) fail(object, ": at must be a place on its surface, as a soft body has no elements to follow");
    return mapping::pointOnTriangle(mapped(on->surface), on->triangle, on->weights, object);
}

} // namespace

void Followers::follow(visual::Transform& transform, BodyId id, const FollowDef& def,
                       const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("'", transform.name(), "' follows ", physics::describeBody(*body));
    validate(def, object);
    if (std::abs(dot(def.offset.orientation, def.offset.orientation) - 1.0) > 2e-6)
        fail(object, ": offset.orientation must have length 1, got ",
             std::sqrt(dot(def.offset.orientation, def.offset.orientation)));

    Follower follower{.transform = &transform, .life = transform.life(), .id = id, .offset = def.offset};
    Pose start;
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&*body)) {
        const mapping::SurfacePoint point = pointOf(*soft, def, object);
        start = point.rest;
        follower.last = point.rest.orientation;
        follower.map = point;
    } else if (std::holds_alternative<physics::RodBodyDef>(*body)) {
        fail(object, ": a rod cannot be followed yet");
    } else {
        const auto& elements = std::get<physics::RigidBodyDef>(*body).elements;
        const auto* at = std::get_if<FollowElement>(&def.at);
        if (!at) fail(object, ": at must be an element, as a rigid body has no surface that deforms");
        const int count = static_cast<int>(elements.size());
        if (at->element >= count) fail(object, ": at.element must be in [0, ", count, "), got ", at->element);
        start = elements[static_cast<std::size_t>(at->element)];
        follower.map = mapping::RigidMap{at->element};
    }
    unfollow(transform);
    transform.detach();
    put(transform, start, def.offset);
    followers_.push_back(std::move(follower));
}

void Followers::unfollow(const visual::Transform& transform)
{
    std::erase_if(followers_, [&](const Follower& each) { return each.transform == &transform; });
}

void Followers::update(const frame::Frame& frame, const physics::PhysicsServer& physics)
{
    std::erase_if(followers_, [&](Follower& each) {
        if (each.life.expired() || each.transform->parent()) return true;
        const bool found = place(each, frame);
        each.seen = each.seen || found;
        return !found && (each.seen || !physics.has(each.id)); // a body that has not come yet is waited for
    });
}

bool Followers::place(Follower& follower, const frame::Frame& frame)
{
    if (const auto* point = std::get_if<mapping::SurfacePoint>(&follower.map)) {
        const frame::SoftBodyFrame* body = frame.softBody(follower.id);
        if (!body) return false;
        const Pose at = mapping::apply(*point, *body, follower.last);
        follower.last = at.orientation;
        put(*follower.transform, at, follower.offset);
    } else {
        const frame::RigidBodyFrame* body = frame.rigidBody(follower.id);
        if (!body) return false;
        put(*follower.transform, mapping::apply(std::get<mapping::RigidMap>(follower.map), *body), follower.offset);
    }
    return true;
}

} // namespace filasofia::runtime
