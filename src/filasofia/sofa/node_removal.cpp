#include "filasofia/sofa/node_removal.h"

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/Simulation.h>

#include <vector>

namespace filasofia::sofaengine {

void removeNode(::sofa::simulation::Node::SPtr& node)
{
    std::vector<::sofa::core::objectmodel::BaseObject::SPtr> components;
    for (const auto& each : node->object) components.push_back(each);
    ::sofa::simulation::node::unload(node);
    // SOFA's assembled systems give a component slaves that hold their master: without this neither would be deleted.
    for (const auto& each : components) {
        const auto slaves = each->getSlaves(); // a copy: the list shrinks
        for (const auto& slave : slaves) each->removeSlave(slave);
    }
    node.reset();
}

} // namespace filasofia::sofaengine
