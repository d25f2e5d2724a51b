#pragma once

#include "filasofia/engine/collision/find_proximities.h"
#include "filasofia/engine/contact/joint_constraints.h"
#include "filasofia/engine/contact/solve_island.h"

#include <set>

namespace filasofia::engine {

/// A contact as it was found, beside its link.
struct FoundContact {
    ContactMemory memory;   ///< its name, its place, and the force that it starts from
    double gap = 0.0;       ///< [m]
    double proximity = 0.0; ///< [m] of both surfaces together
    double skin = 0.0;      ///< [m] the gap that it is to hold
};

/// What ties the bodies of a step together.
struct Coupling {
    RigidPlan rigid; ///< how rigid elements move through the step
    ArticulationPlans articulations;

    std::vector<CollisionSurface> surfaces;                ///< every body's, in the order of softBodies and rigidBodies
    std::vector<std::array<SurfaceName, 2>> startedInside; ///< of each other, deeper than contacts are followed
    std::set<int> warnedGroups; ///< of collision: the log has told that they are one body's alone
    std::set<int> warnedThin;   ///< of collision: the log has told that their proximities are too small
    ProximityScratch proximityScratch;
    std::vector<Proximity> proximities;
    std::vector<SideKept> sides; ///< those of the next step
    std::vector<FoundContact> contacts;
    std::vector<Vec3> normals; ///< of a surface's triangles
    std::vector<Link> links;   ///< one per contact, then those of attachments, then those of joints
    std::vector<JointLink> jointLinks;

    IslandScratch scratch;
};

} // namespace filasofia::engine
