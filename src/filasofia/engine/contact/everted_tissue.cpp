#include "filasofia/engine/contact/everted_tissue.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/collision/find_proximities.h"

namespace filasofia::engine {
namespace {

constexpr double kFast = 0.5; ///< [-] how much nearer surfaces come in a step, relative to a proximity

} // namespace

bool onInvertedElement(const SurfaceOwner& owner, const Proximity& found, std::size_t side, const Scene& scene)
{
    const CollisionModel& collision = *owner.collision;
    if (!owner.soft || collision.behind.empty()) return false;
    const std::vector<Vec3>& x = scene.soft[owner.body].state.x;
    const auto node = [&](int vertex) { return collision.embedding.nodes[static_cast<std::size_t>(vertex)][0]; };
    for (int vertex : found.vertices[side]) {
        if (vertex < 0) continue;
        for (int triangle : collision.shape->vertexTriangles[vertex]) {
            const auto [a, b, c] = collision.shape->triangles[static_cast<std::size_t>(triangle)];
            const int d = collision.behind[static_cast<std::size_t>(triangle)];
            if (geometry::signedVolume(x[node(a)], x[node(b)], x[node(c)], x[d]) >= 0.0)
                return true; // it faces inwards
        }
    }
    return false;
}

bool staysAtInverted(const SurfaceOwner& other, const std::vector<CollisionSurface>& surfaces, double dt,
                     std::size_t side, Proximity& found)
{
    if (other.soft) return false;
    const CollisionSurface& surface = surfaces[static_cast<std::size_t>(found.surfaces[1 - side])];
    if (!surface.shape->triangleFaces) return false;
    if (found.vertices[side][1] < 0 && found.vertices[1 - side][1] >= 0) return true;
    if (!surface.shape->closed) return false;
    const Vec3 out = featureNormal(surface, found.vertices[1 - side]); // from the other side to this one
    const double along = dot(found.normal, side == 0 ? out : -out);
    if (along == 0.0) return false;
    Proximity turned = found;
    if (along < 0.0) turned.normal = -found.normal, turned.gap = -found.gap;
    if (!(dt * closingSpeed(surfaces, turned) > kFast * other.collision->proximity)) return false;
    found = turned;
    return true;
}

} // namespace filasofia::engine
