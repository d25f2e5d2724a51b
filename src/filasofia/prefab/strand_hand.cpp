#include "filasofia/prefab/strand_hand.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/defs.h"

#include <algorithm>
#include <cmath>

namespace filasofia::prefab {
namespace {

constexpr double kNear = 1e-3; ///< [m] least distance of a hand from the origin

Vec3 forceOf(AttachmentId grip, const frame::Frame& now)
{
    const auto held = std::ranges::find(now.attachments, grip, &frame::Attachment::id);
    return held != now.attachments.end() ? held->force : Vec3{};
}

} // namespace

Vec3 turnedTowards(Vec3 from, Vec3 to, double most)
{
    const Vec3 axis = cross(from, to);
    const double angle = std::atan2(length(axis), dot(from, to));
    return angle <= most ? to : rotate(axisAngle(axis, most), from);
}

void StrandHand::place(Vec3 at, Vec3 origin, Vec3 up)
{
    away = std::max(distance(at, origin), kNear);
    direction = normalized(at - origin, up);
}

void StrandHand::moveBy(double way) { away = std::max(away + way, kNear); }

double StrandHand::tension(const frame::Frame& now) const { return dot(forceOf(grip, now), direction); }

double StrandHand::pull(const frame::Frame& now) const { return length(forceOf(grip, now)); }

double drawnBy(double missing, double stiffness, double most) { return std::clamp(missing / stiffness, -most, most); }

std::vector<int> heldNodes(runtime::Simulation& simulation, BodyId thread, std::vector<int> nodes,
                           const std::string& object)
{
    const auto body = simulation.physics().def(thread);
    const auto* rod = std::get_if<physics::RodBodyDef>(body.get());
    if (rod == nullptr) fail(object, ": thread must be a rod, got ", physics::describeBody(*body));
    if (rod->closed) fail(object, ": thread must have ends, got rod '", rod->name, "', a ring");
    if (!rod->collision || !rod->collision->self)
        fail(object, ": thread must collide with itself (collision.self), got rod '", rod->name, "'");
    const int count = static_cast<int>(physics::centreLine(*rod).size());
    if (nodes.empty()) nodes = {0, count - 1};
    if (nodes.size() != 2) fail(object, ": nodes must be two or none, got ", nodes.size());
    for (const int node : nodes)
        if (node >= count) fail(object, ": nodes must be in [0, ", count - 1, "], got ", node);
    if (nodes[0] == nodes[1]) fail(object, ": nodes must differ, got twice ", nodes[0]);
    return nodes;
}

void makeAxes(Vec3& up, Vec3& across, const std::string& object)
{
    const Vec3 first = normalized(up), second = normalized(across);
    if (length(cross(first, second)) < 1e-3)
        fail(object, ": up and across must not be parallel, nor 0, got (", up.x, " ", up.y, " ", up.z, ") and (",
             across.x, " ", across.y, " ", across.z, ")");
    up = first;
    across = normalized(second - dot(second, first) * first);
}

} // namespace filasofia::prefab
