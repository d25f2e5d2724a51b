#include "filasofia/engine/topology/edit_collision.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/contact/warm_start.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

bool inUse(const CollisionShape& shape, int vertex) { return !shape.vertexEdges[vertex].empty(); }

/// The new number of a feature; -1 if it no longer exists.
int featureNow(int feature, const CollisionShape& before, const CollisionShape& now, const ShapeChange& change)
{
    if (feature < before.edgeFeature(0)) return inUse(now, feature) ? feature : -1;
    if (feature < before.triangleFeature(0)) {
        const int edge = change.edges[feature - before.edgeFeature(0)];
        return edge < 0 ? -1 : now.edgeFeature(edge);
    }
    const int triangle = change.triangles[feature - before.triangleFeature(0)];
    return triangle < 0 ? -1 : now.triangleFeature(triangle);
}

void editMemories(SurfaceName name, const CollisionShape& before, const CollisionShape& now, const ShapeChange& change,
                  std::vector<CachedContact>& memories)
{
    std::erase_if(memories, [&](CachedContact& memory) {
        FeaturePair pair = featurePair(memory.feature);
        for (std::size_t side = 0; side < 2; ++side) {
            if (SurfaceName{side == 0 ? memory.first : memory.second, pair.models[side]} != name) continue;
            pair.features[side] = featureNow(pair.features[side], before, now, change);
            if (pair.features[side] < 0) return true;
        }
        memory.feature = featureNumber(pair);
        return false;
    });
    sortCache(memories);
}

void editSides(SurfaceName name, const CollisionShape& now, std::vector<SheetSide>& sides)
{
    std::erase_if(sides, [&](const SheetSide& kept) {
        if (kept.source == name && !inUse(now, kept.point)) return true;
        return kept.target == name &&
               std::ranges::any_of(kept.feature, [&](int vertex) { return vertex >= 0 && !inUse(now, vertex); });
    });
}

/// Per triangle, the node behind it after the edit.
std::vector<int> behindNow(const OwnSurfaceEdit& edit, const ShapeChange& change, const std::vector<int>& before)
{
    if (!edit.behind.empty()) return edit.behind;
    std::vector<int> behind(before.size() - edit.surface.removed.size());
    for (std::size_t t = 0; t < before.size(); ++t)
        if (change.triangles[t] >= 0) behind[change.triangles[t]] = before[t];
    return behind;
}

} // namespace

void editCollision(const OwnSurfaceEdit& edit, int model, SoftModel& body, Scene& scene)
{
    CollisionModel& collision = body.collision[static_cast<std::size_t>(model)];
    FILASOFIA_ASSERT(edit.nodes.size() == edit.surface.vertices.size());
    FILASOFIA_ASSERT(!edit.behind.empty() || (edit.surface.changed.empty() && edit.surface.added.empty()));
    const std::shared_ptr<const CollisionShape> before = collision.shape;
    ShapeChange change;
    CollisionShape now = editShape(*before, edit.surface, change);
    collision.inset = collision.round > 0.0
                          ? roundInset(now, collision.round)
                          : editInset(collision.inset, *before, now, change, insetDepth(collision.proximity));
    setProximity(collision, now);
    if (!collision.behind.empty()) collision.behind = behindNow(edit, change, collision.behind);
    addToEmbedding(edit.nodes, collision.embedding);
    const SurfaceName name{body.id, model};
    editMemories(name, *before, now, change, scene.contacts);
    editSides(name, now, scene.sides);
    collision.shape = std::make_shared<const CollisionShape>(std::move(now));
    FILASOFIA_ASSERT(collision.behind.empty() || collision.behind.size() == collision.shape->triangles.size());
}

} // namespace filasofia::engine
