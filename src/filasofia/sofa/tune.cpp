#include "filasofia/sofa/tune.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/sofa/graph_owner.h"

namespace filasofia::sofaengine {

void tune(physics::PhysicsServer& server,
          std::function<void(::sofa::simulation::Node& root, const NodeOf& nodeOf)> change)
{
    if (!change) fail("tune: the function to run must not be empty");
    if (!dynamic_cast<const GraphOwner*>(&server.engine())) fail("tune: the engine 'sofa' is not in use");
    server.tune([change = std::move(change)](physics::PhysicsEngine& engine) {
        const GraphOwner& world = dynamic_cast<GraphOwner&>(engine);
        change(world.root(), [&world](BodyId id) { return world.nodeOf(id); });
    });
}

} // namespace filasofia::sofaengine
