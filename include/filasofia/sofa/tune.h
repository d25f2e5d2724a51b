#pragma once

#include "filasofia/core/body_id.h"

#include <functional>

namespace sofa::simulation {
class Node;
}
namespace filasofia::physics {
class PhysicsServer;
}

/// Access to SOFA's graph, for components and data that no Def has. A program that changes nodes includes SOFA's
/// headers and links its libraries.
namespace filasofia::sofaengine {

/// The node of a body: its state is called "state", its law "law". Null if there is no such body.
using NodeOf = std::function<::sofa::simulation::Node*(BodyId)>;

/// Runs `change` once, at the start of the next step. It initialises what it adds:
/// sofa::simulation::node::init(&node), or the component's own init(). If it throws, the bodies' states are restored,
/// an error is logged and the step has StepFlag::TuneRejected; components that it added stay. Throws an Error if the
/// server has another engine or if `change` is empty.
void tune(physics::PhysicsServer& server,
          std::function<void(::sofa::simulation::Node& root, const NodeOf& nodeOf)> change);

} // namespace filasofia::sofaengine
