#pragma once

#include "filasofia/engine/scene/find_body.h"

namespace filasofia::engine {

/// [m] The radius of a line that runs through a channel: that of a rod, or of a rigid body's needle. 0 if the body was
/// removed, as its channel still has it for a while.
inline double lineRadius(const Scene& scene, BodyId line)
{
    const auto place = findBody(scene, line);
    if (!place) return 0.0;
    return place->soft ? scene.soft[place->index].model.rod.radius : scene.rigid[place->index].model.needle->radius;
}

} // namespace filasofia::engine
