#pragma once

#include "filasofia/engine/collision/find_proximities.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/contact/solve_island.h"
#include "filasofia/physics/step.h"

#include <set>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Surfaces that pass through each other, as the tests of edges against triangles have found them
/// (reportIntersections).
struct IntersectionWatch {
    std::vector<physics::Intersection> told; ///< at the last test
    /// The same, of bodies that pass through themselves because they do not collide with themselves.
    std::vector<physics::Intersection> folded;
    /// Two surfaces that pass through each other deeper than any contact between them knows.
    struct Unseen {
        std::array<SurfaceName, 2> surfaces;
        double since = 0.0; ///< [s] simulated time of the first test in a row
    };
    std::vector<Unseen> unseen; ///< with names that ascend
    /// Pairs of which contacts had lost a place at the last test: until they part, they are followed at any depth.
    std::vector<Unseen> lost;
    /// A surface that is told where to be.
    struct Told {
        SurfaceName surface;
        std::array<Vec3, 2> ends; ///< [m] its first and its last vertex
        double moved = 0.0;       ///< [s] when it last moved
    };
    std::vector<Told> tools;
};

/// The data of contact detection. Only `surfaces`, `startedInside`, the intersections and the warned groups carry
/// over from step to step.
struct ContactDetection {
    std::vector<CollisionSurface> surfaces; ///< every body's, in the order of Scene::soft and Scene::rigid
    /// Pairs that started inside each other, deeper than contacts are followed.
    std::vector<std::array<SurfaceName, 2>> startedInside;
    IntersectionWatch intersections;
    std::set<int> warnedGroups;     ///< collision groups for which the log has said that only one body has them
    std::set<int> warnedIdle;       ///< collision groups for which the log has said that blades in them cut nothing
    std::vector<BodyId> idleBlades; ///< rigid bodies of which blades cut nothing
    std::set<int> warnedForBlades;  ///< collision groups for which the log has said that only blades meet a soft body
    std::set<int> warnedThin;       ///< collision groups for which the log has said that the proximities are too small
    ProximityScratch scratch;
    std::vector<Proximity> proximities;
    std::vector<char> followed;         ///< per proximity: whether it is a contact
    std::vector<SheetSide> sides;       ///< sides for the next step
    std::vector<PushedFeatures> pushed; ///< what pushed in the last step, ascending
    std::vector<Vec3> normals;          ///< scratch: the normals of a surface's triangles
};

/// The coupling of the bodies in a step: the unconstrained motion of the rigid ones, and all constraints.
struct Coupling {
    RigidPlan rigid;
    ArticulationPlans articulations;
    ContactDetection detection;

    std::vector<Constraint>
        constraints; ///< contacts, welds, channels, clips, then limits, friction and springs of joints
    std::size_t contactCount = 0;
    std::size_t weldCount = 0;
    std::size_t channelCount = 0;
    std::size_t clipLegCount = 0;

    [[nodiscard]] std::span<Constraint> contacts() { return std::span(constraints).first(contactCount); }
    [[nodiscard]] std::span<const Constraint> contacts() const { return std::span(constraints).first(contactCount); }
    [[nodiscard]] std::span<const Constraint> welds() const
    {
        return std::span(constraints).subspan(contactCount, weldCount);
    }
    [[nodiscard]] std::span<const Constraint> channels() const
    {
        return std::span(constraints).subspan(contactCount + weldCount, channelCount);
    }
    [[nodiscard]] std::span<const Constraint> joints() const
    {
        return std::span(constraints).subspan(contactCount + weldCount + channelCount + clipLegCount);
    }

    IslandScratch scratch;
};

/// Removes the contacts from number `begin` on for which `isGone(contact)` is true; it may change the others. Other
/// constraints stay, behind the contacts.
template <class IsGone> void eraseContacts(const IsGone& isGone, Coupling& coupling, std::size_t begin = 0)
{
    std::size_t kept = begin;
    for (std::size_t c = begin; c < coupling.contactCount; ++c) {
        if (isGone(coupling.constraints[c])) continue;
        if (kept != c) coupling.constraints[kept] = coupling.constraints[c];
        ++kept;
    }
    const auto first = coupling.constraints.begin();
    coupling.constraints.erase(first + static_cast<std::ptrdiff_t>(kept),
                               first + static_cast<std::ptrdiff_t>(coupling.contactCount));
    coupling.contactCount = kept;
}

} // namespace filasofia::engine
