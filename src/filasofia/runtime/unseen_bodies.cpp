#include "filasofia/runtime/unseen_bodies.h"

#include "filasofia/core/log.h"
#include "filasofia/core/text.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace filasofia::runtime {
namespace {

/// Along the axis of a camera, ahead of it.
struct Reach {
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest; ///< [m]
    void add(double depth)
    {
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
};

} // namespace

void UnseenBodies::look(const visual::VisualServer& server)
{
    if (std::exchange(looked_, true)) return;
    std::vector<const visual::VisualBody*> bodies;
    for (const visual::VisualBody* body : server.bodies())
        if (body->worldVisible()) bodies.push_back(body);
    if (bodies.empty()) return;
    for (const visual::View* view : server.views()) {
        if (!view->visible()) continue;
        const visual::CameraDef& lens = view->camera().def();
        const Pose toCamera = inverse(view->camera().worldPose());
        Reach all;
        const bool seen = std::ranges::any_of(bodies, [&](const visual::VisualBody* body) {
            const Pose pose = toCamera * body->worldPose();
            const double scale = body->worldScale();
            Reach reach;
            for (const Vec3 vertex : body->vertices()) {
                const double depth = -transform(pose, scale * vertex).z;
                if (depth >= lens.near && depth <= lens.far) return true; // mostly the first one
                reach.add(depth);
            }
            all.add(reach.nearest);
            all.add(reach.farthest);
            return reach.farthest >= lens.near && reach.nearest <= lens.far;
        });
        if (seen) continue;
        const std::string camera = text("camera '", lens.name, "' shows no body: it shows what is ", lens.near,
                                        " (near) to ", lens.far, " m (far) ahead");
        if (told_.insert(camera).second)
            logWarning(camera, ", and the bodies are at ", all.nearest, " to ", all.farthest, " m",
                       all.farthest < 0.0 ? ", behind it" : "");
    }
}

} // namespace filasofia::runtime
