#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/rigid/rigid_step.h"

#include <optional>
#include <span>

namespace filasofia::engine {

/// Bodies that constraints connect, and so must be solved together.
struct Island {
    std::vector<std::size_t> soft;        ///< indices among the soft bodies, ascending
    std::vector<std::size_t> rigid;       ///< in the rigid plan, dynamic elements only, or bases of links; ascending
    std::vector<std::size_t> constraints; ///< indices in the list of constraints, ascending
};

/// The element of the plan by which a rigid body moves as one with a point: that element, or the base of a link. None
/// if nothing can move it.
std::optional<std::size_t> planPlace(const RigidPlan& plan, const BodyPoint& point);

/// The islands, in the order of their first bodies; bodies without a constraint are in none. What cannot be moved
/// (space, kinematic elements) connects nothing, and a constraint between two such is in no island.
std::vector<Island> findIslands(std::size_t softBodies, const RigidPlan& plan, std::span<const Constraint> constraints);

} // namespace filasofia::engine
