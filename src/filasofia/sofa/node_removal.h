#pragma once

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/Node.h>

#include <vector>

namespace filasofia::sofaengine {

/// SOFA's assembled systems give a component slaves that hold their master, so that neither would be deleted. This
/// parts all in a graph that will go: those of the systems that bodies have at once, others at its end, contacts that
/// have gone meanwhile included. Their systems must have gone then too: they keep pointers.
class PartedSlaves {
public:
    explicit PartedSlaves(const ::sofa::simulation::Node& node);
    ~PartedSlaves();
    PartedSlaves(const PartedSlaves&) = delete;
    PartedSlaves& operator=(const PartedSlaves&) = delete;

private:
    std::vector<::sofa::core::objectmodel::BaseObject::SPtr> components_;
};

/// Takes a node out of its graph and deletes it with its components.
void removeNode(::sofa::simulation::Node::SPtr& node);

} // namespace filasofia::sofaengine
