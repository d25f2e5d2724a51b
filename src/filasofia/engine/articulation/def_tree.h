#pragma once

#include "filasofia/engine/articulation/link_tree.h"
#include "filasofia/physics/defs.h"

namespace filasofia::engine {

/// The tree of links that a Def describes; empty without joints. Throws an Error if an offset has no orientation.
LinkTree treeOf(const physics::ArticulationDef& def);

/// The command of each joint at the start: without one it keeps its position.
std::vector<physics::JointCommand> startCommands(const physics::ArticulationDef& def);

} // namespace filasofia::engine
