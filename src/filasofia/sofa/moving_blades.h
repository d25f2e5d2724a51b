#pragma once

#include "filasofia/engine/rupture/stroke.h"
#include "filasofia/sofa/scene_state.h"

#include "filasofia/geometry/box.h"

namespace filasofia::sofaengine {

/// A collision model that cuts, with the positions of its vertices at the start and the end of the step.
struct MovingBlade {
    BodyId body = {};
    int group = 0;
    std::span<const std::array<int, 2>> lines = {}; ///< in the plan of its body
    std::vector<Vec3> before = {}, now = {};        ///< [m]
    bool jumped = false;                            ///< it moved further than allowed in a step: it has no path
    geometry::Box swept = {};                       ///< around its positions at the start and the end

    [[nodiscard]] engine::BladePath path() const { return {lines, before, now}; }
};

/// The blades that are on, in the order of their bodies.
std::vector<MovingBlade> moveBlades(const SceneMotion& before, double dt, const SofaScene& scene);

/// Those near a body that they cut, sorted by tool. Blades that jumped across it are counted.
std::vector<engine::Tool> toolsNear(const SoftNode& body, const std::vector<Vec3>& positions,
                                    const std::vector<MovingBlade>& blades, physics::TopologyReport& report);

} // namespace filasofia::sofaengine
