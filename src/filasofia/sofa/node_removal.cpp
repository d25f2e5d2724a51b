#include "filasofia/sofa/node_removal.h"

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/Simulation.h>

#include <vector>

namespace filasofia::sofaengine {
namespace {

using Components = std::vector<::sofa::core::objectmodel::BaseObject::SPtr>;

void addComponents(const ::sofa::simulation::Node& node, Components& out)
{
    for (const auto& each : node.object) out.push_back(each);
    for (const auto& below : node.child) addComponents(*below, out);
}

} // namespace

void removeNode(::sofa::simulation::Node::SPtr& node)
{
    Components components;
    addComponents(*node, components);
    ::sofa::simulation::node::unload(node);
    // SOFA's assembled systems give a component slaves that hold their master: without this neither would be deleted.
    for (const auto& each : components) {
        const auto slaves = each->getSlaves(); // a copy: the list shrinks
        for (const auto& slave : slaves) each->removeSlave(slave);
    }
    node.reset();
}

} // namespace filasofia::sofaengine
