#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/rigid/rigid_step.h"

#include <optional>
#include <span>

namespace filasofia::engine {

/// Bodies that constraints connect, so that they must be solved together.
struct Island {
    std::vector<std::size_t> soft;        ///< indices among the soft bodies, ascending
    std::vector<std::size_t> rigid;       ///< dynamic elements or articulations' bases in the rigid plan; ascending
    std::vector<std::size_t> constraints; ///< indices in the list of constraints, ascending
};

/// The element of the plan that stands for the point's body in a solve: the point's element, or the base of its
/// articulation. None if nothing can move the point.
std::optional<std::size_t> planPlace(const RigidPlan& plan, const BodyPoint& point);

/// The unit that the point's body is in a solve: its index among the soft bodies, or `softBodies` plus its planPlace().
/// None if nothing can move the point.
std::optional<std::size_t> unitOf(std::size_t softBodies, const RigidPlan& plan, const BodyPoint& point);

/// The islands, in the order of their first bodies. Bodies without a constraint are in none. Space and
/// kinematic elements connect nothing, and a constraint between two of them is in no island. `apart`: per constraint,
/// whether it is to be left out; empty: none is.
std::vector<Island> findIslands(std::size_t softBodies, const RigidPlan& plan, std::span<const Constraint> constraints,
                                std::span<const char> apart = {});

} // namespace filasofia::engine
