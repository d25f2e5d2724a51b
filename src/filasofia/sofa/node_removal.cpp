#include "filasofia/sofa/node_removal.h"

#include <sofa/simulation/Simulation.h>

namespace filasofia::sofaengine {
namespace {

using Components = std::vector<::sofa::core::objectmodel::BaseObject::SPtr>;

void addComponents(const ::sofa::simulation::Node& node, Components& out)
{
    for (const auto& each : node.object) out.push_back(each);
    for (const auto& below : node.child) addComponents(*below, out);
}

} // namespace

PartedSlaves::PartedSlaves(const ::sofa::simulation::Node& node) { addComponents(node, components_); }

PartedSlaves::~PartedSlaves()
{
    for (const auto& each : components_) {
        const auto slaves = each->getSlaves(); // a copy: the list shrinks
        for (const auto& slave : slaves) each->removeSlave(slave);
    }
}

void removeNode(::sofa::simulation::Node::SPtr& node)
{
    const PartedSlaves parted(*node);
    ::sofa::simulation::node::unload(node);
    node.reset();
}

} // namespace filasofia::sofaengine
