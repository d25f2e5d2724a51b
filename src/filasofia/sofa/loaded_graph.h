#pragma once

#include "filasofia/sofa/load.h"
#include "filasofia/sofa/sofa_vec.h"

#include "filasofia/physics/defs.h"

#include <sofa/core/State.h>
#include <sofa/simulation/Node.h>

namespace filasofia::sofaengine {

/// An object of a loaded graph, as a body of ours.
struct LoadedItem {
    std::string name = {};
    physics::BodyDef def = {}; ///< what it is at the start, for whoever shows it; SOFA moves it
    bool picture = false;
    std::vector<int> vertices = {}; ///< the state's node of each vertex of the body; empty: they are the nodes
    ::sofa::core::State<Vec3Types>* soft = nullptr;
    ::sofa::core::State<RigidTypes>* rigid = nullptr;
};

/// Reads a scene of SOFA and makes it ready for steps. Throws an Error that begins with the file's name.
::sofa::simulation::Node::SPtr loadGraph(const LoadDef& def);

/// Its states that have elements, in the order of the graph; `left`: the names of all others. `unit` [m] is the
/// scene's unit of length.
std::vector<LoadedItem> itemsOf(::sofa::simulation::Node& root, double unit, std::vector<std::string>& left);

/// All numbers that a step changes.
using GraphState = std::vector<std::vector<double>>;
GraphState stateOfGraph(::sofa::simulation::Node& root);
/// The graph must have the same states.
void setGraphState(const GraphState& state, ::sofa::simulation::Node& root);
/// Whether every number is finite, and as small as numbers in frames must be.
bool isUsable(const GraphState& state, double unit);

} // namespace filasofia::sofaengine
