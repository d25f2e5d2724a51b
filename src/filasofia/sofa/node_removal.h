#pragma once

#include <sofa/simulation/Node.h>

namespace filasofia::sofaengine {

/// Takes a node out of its graph and deletes it with its components.
void removeNode(::sofa::simulation::Node::SPtr& node);

} // namespace filasofia::sofaengine
