#pragma once

#include "filasofia/engine/constraint/body_point.h"
#include "filasofia/engine/body/model.h"
#include "filasofia/engine/rigid/rigid_step.h"

#include <optional>

namespace filasofia::engine {

/// Bodies that links tie to each other, and so must be solved together.
struct Island {
    std::vector<std::size_t> soft;  ///< places among the soft bodies, ascending
    std::vector<std::size_t> rigid; ///< places in the rigid plan, dynamic elements only, or bases of links; ascending
    std::vector<std::size_t> links; ///< places in the list of links, ascending
};

/// By which of its elements in the plan a rigid body moves as one with a point: that element, or the base of a link.
/// None where nothing can move it.
std::optional<std::size_t> planPlace(const RigidPlan& plan, const BodyPoint& point);

/// The islands, in the order of their first bodies; bodies that no link takes hold of are in none. What cannot be moved
/// (space, elements that go where they are told) ties nothing together, and a link between two such is in no island.
std::vector<Island> findIslands(const Model& model, const RigidPlan& plan, const std::vector<Link>& links);

} // namespace filasofia::engine
