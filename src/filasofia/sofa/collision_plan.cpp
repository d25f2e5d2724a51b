#include "filasofia/sofa/collision_plan.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/surface.h"

namespace filasofia::sofaengine {
namespace {

void checkModel(const physics::CollisionDef& def, const std::string& field)
{
    const physics::Primitives& p = def.primitives;
    if (!p.points && !p.lines && !p.triangles)
        fail(field, ".primitives must have points, lines or triangles, got none");
    // Surfaces at rest on each other must have a distance: its direction is the normal. A blade's edge has none.
    if (!def.cutting && !(def.proximity > 0.0))
        fail(field, ".proximity must be > 0 m with the engine 'sofa', got ", def.proximity);
}

/// [m] by which surfaces of rigid bodies are drawn in: SOFA knows no side, and no normal, of surfaces that touch
/// exactly, as those of bodies that were placed on each other do.
constexpr double kInset = 1e-6;

void drawIn(geometry::TriangleMesh& mesh)
{
    std::vector<Vec3> normals(mesh.vertices.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto vertex = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
        const Vec3 area = cross(vertex(b) - vertex(a), vertex(c) - vertex(a));
        for (const int each : {a, b, c}) normals[static_cast<std::size_t>(each)] += area;
    }
    for (std::size_t i = 0; i < normals.size(); ++i)
        if (length(normals[i]) > 0.0) mesh.vertices[i] -= kInset * normalized(normals[i]);
}

} // namespace

std::vector<CollisionPlan> planCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& world,
                                         const std::string& object)
{
    std::vector<CollisionPlan> plans;
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const std::string field = text(object, ": collision[", i, "]");
        if (def.collision[i].cutting) continue; // it names a group of blades: see mayBeCut()
        checkModel(def.collision[i], field);
        // Both sides of a cut touch exactly, vertex on vertex, and SOFA sees no contact there, nor from inside.
        if (def.dynamicTopology && def.collision[i].selfOnceCut.value_or(false) && !def.collision[i].self)
            logWarning(field, ".selfOnceCut: with the engine 'sofa' the sides of a cut pass through each other");
        CollisionPlan& plan = plans.emplace_back(CollisionPlan{.def = def.collision[i]});
        if (const auto given = physics::loadMesh(plan.def.mesh, field + ".mesh")) {
            if (def.dynamicTopology)
                logWarning(field, ".mesh: deforms with the body but does not open if the body is cut or torn; without "
                                  "a mesh the body's own surface is used, which does");
            plan.mesh = *given;
            const Pose pose = physics::unitPose(def.pose, object);
            for (Vec3& vertex : plan.mesh.vertices) vertex = transform(pose, vertex);
        } else {
            geometry::Surface surface = geometry::extractSurface(world);
            plan.mesh = std::move(surface.mesh);
            plan.nodes = std::move(surface.nodes);
        }
    }
    return plans;
}

std::vector<CollisionPlan> planCollision(const physics::RigidBodyDef& def, const std::string& object)
{
    std::vector<CollisionPlan> plans;
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const std::string field = text(object, ": collision[", i, "]");
        checkModel(def.collision[i], field);
        CollisionPlan& plan = plans.emplace_back(CollisionPlan{.def = def.collision[i]});
        auto mesh = physics::loadMesh(plan.def.mesh, field + ".mesh");
        if (!mesh) mesh = physics::loadMesh(def.mesh, object + ": mesh");
        if (!mesh) fail(field, ".mesh: no mesh is given, and the body has none");
        plan.mesh = *mesh;
        if (!plan.def.cutting) drawIn(plan.mesh); // a blade cuts where it is
    }
    return plans;
}

} // namespace filasofia::sofaengine
