#include "filasofia/engine/topology/cut_attachments.h"

#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// Whether a blade may cut the soft body; other bodies are not cut.
bool mayCut(const Blade& blade, const Scene& scene, BodyId id)
{
    const auto place = findBody(scene, id);
    return place && place->soft && mayBeCut(scene.soft[place->index].model, blade.shape->group);
}

} // namespace

void cutAttachments(std::span<const Blade> blades, Scene& scene)
{
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        Attachment& each = scene.attachments[a];
        if (each.cutDistance == 0.0) continue;
        const SoftBody& body = scene.soft[findBody(scene, each.body)->index];
        std::vector<bool> gone(each.pairs.size());
        for (const Blade& blade : blades) {
            if (blade.jumped || !(mayCut(blade, scene, each.body) || mayCut(blade, scene, each.to))) continue;
            const geometry::Box around = geometry::grown(blade.swept, each.cutDistance);
            for (std::size_t p = 0; p < gone.size(); ++p) {
                const Vec3 place = meanOf(each.pairs[p][0].nodes, body.state.x);
                if (!gone[p] && overlap(around, {place, place}))
                    gone[p] = distanceTo({blade.lines, blade.before, blade.now}, place) <= each.cutDistance;
            }
        }
        if (std::ranges::count(gone, true) > 0) each.parted += erasePairs(a, gone, scene);
    }
}

} // namespace filasofia::engine
