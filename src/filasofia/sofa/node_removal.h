#pragma once

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/Node.h>

#include <vector>

namespace filasofia::sofaengine {

using Components = std::vector<::sofa::core::objectmodel::BaseObject::SPtr>;
/// Adds all components of a node and of those below it.
void addComponents(const ::sofa::simulation::Node& node, Components& out);

/// SOFA's assembled systems give a component slaves that hold their master, so that neither would be deleted. At its
/// end this parts all that were in a graph at its beginning, contacts that have gone meanwhile included. Their systems
/// must have gone too: they keep pointers.
class PartedSlaves {
public:
    explicit PartedSlaves(const ::sofa::simulation::Node& node);
    /// `also`: components that have left the graph before.
    PartedSlaves(const ::sofa::simulation::Node& node, Components also);
    ~PartedSlaves();
    PartedSlaves(const PartedSlaves&) = delete;
    PartedSlaves& operator=(const PartedSlaves&) = delete;

private:
    Components components_;
};

/// Takes a node out of its graph and deletes it with its components.
void removeNode(::sofa::simulation::Node::SPtr& node);

} // namespace filasofia::sofaengine
