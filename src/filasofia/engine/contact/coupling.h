#pragma once

#include "filasofia/engine/collision/find_proximities.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/contact/solve_island.h"

#include <set>
#include <span>
#include <vector>

namespace filasofia::engine {

/// What contact detection works on. Only `surfaces`, `startedInside` and the warnings matter from step to step.
struct ContactDetection {
    std::vector<CollisionSurface> surfaces; ///< every body's, in the order of Scene::soft and Scene::rigid
    std::vector<std::array<SurfaceName, 2>> startedInside; ///< each other, deeper than contacts are followed
    std::set<int> warnedGroups; ///< collision groups: the log has said that they are one body's alone
    std::set<int> warnedThin;   ///< collision groups: the log has said that their proximities are too small
    ProximityScratch scratch;
    std::vector<Proximity> proximities;
    std::vector<SideKept> sides; ///< those of the next step
    std::vector<Vec3> normals;   ///< scratch, of a surface's triangles
};

/// What couples the bodies of a step: how the rigid ones would move by themselves, and all constraints.
struct Coupling {
    RigidPlan rigid;
    ArticulationPlans articulations;
    ContactDetection detection;

    std::vector<Constraint> constraints; ///< contacts, then welds, then those of joints
    std::size_t contactCount = 0;
    std::size_t weldCount = 0;

    [[nodiscard]] std::span<Constraint> contacts() { return std::span(constraints).first(contactCount); }
    [[nodiscard]] std::span<const Constraint> contacts() const { return std::span(constraints).first(contactCount); }
    [[nodiscard]] std::span<const Constraint> welds() const
    {
        return std::span(constraints).subspan(contactCount, weldCount);
    }
    [[nodiscard]] std::span<const Constraint> joints() const
    {
        return std::span(constraints).subspan(contactCount + weldCount);
    }

    IslandScratch scratch;
};

} // namespace filasofia::engine
