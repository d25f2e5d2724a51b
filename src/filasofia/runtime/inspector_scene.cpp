#include "filasofia/runtime/inspector_scene.h"

#include "filasofia/core/sorted.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/visual/visual_server.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace filasofia::runtime {
namespace {

using visual::Color;
using visual::DebugDraw;

constexpr Color kWire = {0.75, 0.85, 0.95}, kModel = {1.0, 0.45, 0.05}, kNear = {0.35, 0.35, 0.4};
constexpr Color kTouching = {1.0, 0.12, 0.08}, kForce = {1.0, 0.8, 0.1}, kSum = {0.15, 0.9, 1.0};

/// The largest of 1, 2, 5 times a power of ten that is not above `value`.
double rounded(double value)
{
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    const double digits = value / power;
    return power * (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0);
}

/// The arrow [m] of a force. Its length is limited, so that no scale leads out of what can be drawn.
Vec3 arrowOf(Vec3 force, double metresPerNewton)
{
    constexpr double kLongest = 1e4; // [m]
    const Vec3 arrow = metresPerNewton * force;
    return length(arrow) > kLongest ? kLongest * normalized(arrow) : arrow;
}

} // namespace

double InspectorScene::scaleOf(const InspectorShow& show) const
{
    return show.metresPerNewton > 0.0 ? show.metresPerNewton : fitted_;
}

void InspectorScene::fitScale(const frame::Frame& frame)
{
    double largest = 0.0; // [N]
    for (const frame::ContactPair& pair : frame::contactPairs(frame.contacts))
        largest = std::max(largest, length(pair.force));
    const geometry::Box around = impl_.bindings.bounds();
    if (!(largest > 1e-9) || geometry::isEmpty(around)) return;
    const double size = std::clamp(length(around.high - around.low), 1e-3, 1e3);
    const double reach = largest * fitted_;
    if (reach > 0.6 * size || reach < 0.03 * size) fitted_ = rounded(0.25 * size / largest);
}

void InspectorScene::draw(const InspectorShow& show, visual::VisualServer& visual)
{
    if (show.wireframe) drawWireframe(visual);
    if (!show.collision && !show.contacts && !show.forces) return;
    const frame::FrameRef frame = impl_.physics.latest();
    if (!frame) return;
    if (show.collision) drawModels(*frame, visual.debug());
    if (show.contacts) drawContacts(*frame, visual.debug());
    if (show.forces && show.metresPerNewton == 0.0) fitScale(*frame);
    if (show.forces) drawForces(*frame, scaleOf(show), visual.debug());
}

InspectorScene::Edges InspectorScene::edgesOf(std::span<const geometry::Triangle> triangles)
{
    Edges edges;
    edges.reserve(3 * triangles.size());
    for (const geometry::Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    sortUnique(edges);
    return edges;
}

void InspectorScene::drawWireframe(visual::VisualServer& visual)
{
    std::map<const visual::VisualBody*, Wires> still; // the bodies that still exist
    for (const visual::VisualBody* body : visual.bodies()) {
        if (!body->visible()) continue;
        Wires wires = std::move(wires_[body]);
        const auto triangles = body->triangles();
        if (!std::equal(wires.triangles.begin(), wires.triangles.end(), triangles.begin(), triangles.end()))
            wires = {{triangles.begin(), triangles.end()}, edgesOf(triangles)};
        const Pose pose = body->worldPose();
        const auto vertices = body->vertices();
        for (const auto& [a, b] : wires.edges)
            visual.debug().line(transform(pose, vertices[std::size_t(a)]), transform(pose, vertices[std::size_t(b)]),
                                {.color = kWire, .width = 1.0});
        still[body] = std::move(wires);
    }
    wires_ = std::move(still);
}

const std::vector<InspectorScene::Model>& InspectorScene::modelsOf(BodyId id)
{
    const auto found = models_.find(id);
    if (found != models_.end()) return found->second;
    std::vector<Model> models;
    const auto def = impl_.physics.def(id);
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&*def)) {
        for (const physics::CollisionDef& collision : soft->collision) {
            const auto given = physics::loadMesh(collision.mesh, soft->name);
            models.push_back({0, mapSoft(*soft, given.get(), soft->name), {}});
        }
    } else if (const auto* rod = std::get_if<physics::RodBodyDef>(&*def)) {
        if (rod->collision) models.push_back({0, mapRod(*rod, nullptr, rod->name), {}});
    } else {
        const auto& rigid = std::get<physics::RigidBodyDef>(*def);
        for (const physics::CollisionDef& collision : rigid.collision) {
            auto mesh = physics::loadMesh(collision.mesh, rigid.name);
            if (!mesh) mesh = physics::loadMesh(rigid.mesh, rigid.name);
            if (mesh) models.push_back({collision.element, {*mesh, {}}, {}});
        }
    }
    for (Model& model : models) model.edges = edgesOf(model.surface.surface.triangles);
    return models_[id] = std::move(models);
}

void InspectorScene::drawModels(const frame::Frame& frame, DebugDraw& debug)
{
    const auto drawEdges = [&](const Model& model) {
        for (const auto& [a, b] : model.edges)
            debug.line(vertices_[std::size_t(a)], vertices_[std::size_t(b)], {.color = kModel, .width = 1.0});
    };
    for (const frame::SoftBodyFrame& body : frame.softBodies) {
        if (!impl_.physics.has(body.id)) continue; // removed; the next frame lacks it
        for (const Model& model : modelsOf(body.id)) {
            vertices_.resize(model.surface.surface.vertices.size());
            mapping::apply(model.surface.map, body, vertices_);
            drawEdges(model);
        }
    }
    for (const frame::RigidBodyFrame& body : frame.rigidBodies) {
        if (!impl_.physics.has(body.id)) continue;
        for (const Model& model : modelsOf(body.id)) {
            vertices_ = model.surface.surface.vertices;
            for (Vec3& vertex : vertices_) vertex = transform(body.poses[std::size_t(model.element)], vertex);
            drawEdges(model);
        }
    }
}

void InspectorScene::drawContacts(const frame::Frame& frame, DebugDraw& debug)
{
    for (const frame::Contact& contact : frame.contacts) {
        const bool pushes = contact.normalForce > 0.0;
        debug.point(contact.point, {.color = pushes ? kTouching : kNear, .width = pushes ? 6.0 : 4.0, .onTop = true});
    }
}

bool InspectorScene::isKinematic(BodyId id) const
{
    if (!impl_.physics.has(id)) return false;
    const auto def = impl_.physics.def(id);
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&*def);
    return rigid && !rigid->dynamic;
}

void InspectorScene::drawForces(const frame::Frame& frame, double metresPerNewton, DebugDraw& debug) const
{
    for (const frame::ContactPair& pair : frame::contactPairs(frame.contacts)) {
        if (!(pair.normalForce > 0.0)) continue;
        const double scale = (isKinematic(pair.first) ? -1.0 : 1.0) * metresPerNewton;
        Vec3 middle; // mean of the contact points, weighted by normal force
        for (const frame::Contact& contact : frame.contacts) {
            if (contact.first != pair.first || contact.second != pair.second || contact.normalForce == 0.0) continue;
            middle += contact.normalForce / pair.normalForce * contact.point;
            debug.arrow(contact.point, contact.point + arrowOf(forceOn(contact.first, contact), scale),
                        {.color = kForce, .width = 1.5, .onTop = true});
        }
        const Vec3 tip = middle + arrowOf(pair.force, scale);
        debug.arrow(middle, tip, {.color = kSum, .width = 3.0, .onTop = true});
        char newtons[32];
        std::snprintf(newtons, sizeof newtons, "%.3g N", length(pair.force));
        debug.text(tip, newtons, {.color = kSum});
    }
}

} // namespace filasofia::runtime
