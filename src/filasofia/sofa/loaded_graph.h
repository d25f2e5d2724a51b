#pragma once

#include "filasofia/sofa/load.h"
#include "filasofia/sofa/loaded_item.h"

#include <sofa/simulation/Node.h>

namespace filasofia::sofaengine {

/// Reads a scene of SOFA and makes it ready for steps. Throws an Error that begins with the file's name.
::sofa::simulation::Node::SPtr loadGraph(const LoadDef& def);

/// Its states that have elements, in the order of the graph; `left`: the names of all others. `unit` [m] is the
/// scene's unit of length.
std::vector<LoadedItem> itemsOf(::sofa::simulation::Node& root, double unit, std::vector<std::string>& left);

/// All numbers that a step changes.
using GraphState = std::vector<std::vector<double>>;
GraphState stateOfGraph(::sofa::simulation::Node& root);
/// The graph must have the same states. One whose mesh has another size than then keeps its numbers, or
/// those of its rest if frames cannot have them.
void setGraphState(const GraphState& state, ::sofa::simulation::Node& root, double unit);
/// Whether every number is finite, and as small as numbers in frames must be.
bool isUsable(const GraphState& state, double unit);

} // namespace filasofia::sofaengine
