#include "filasofia/sofa/node_removal.h"

#include "filasofia/sofa/compliant_factor.h"

#include <sofa/component/linearsystem/MatrixLinearSystem.h>
#include <sofa/simulation/Simulation.h>

namespace filasofia::sofaengine {
namespace {

using Components = std::vector<::sofa::core::objectmodel::BaseObject::SPtr>;

void addComponents(const ::sofa::simulation::Node& node, Components& out)
{
    for (const auto& each : node.object) out.push_back(each);
    for (const auto& below : node.child) addComponents(*below, out);
}

/// Lets an assembled system part its slaves. Only it knows those of contacts that ended in its last step: they have
/// left the graph, and nothing else leads to them.
class PartedSystem final : public ::sofa::component::linearsystem::MatrixLinearSystem<Blocks, Assembled> {
public:
    using System = MatrixLinearSystem<Blocks, Assembled>;
    static void part(System& system) { (system.*&PartedSystem::cleanLocalMatrices)(); }
};

} // namespace

PartedSlaves::PartedSlaves(const ::sofa::simulation::Node& node)
{
    addComponents(node, components_);
    for (const auto& each : components_)
        if (auto* system = dynamic_cast<PartedSystem::System*>(each.get())) PartedSystem::part(*system);
}

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
