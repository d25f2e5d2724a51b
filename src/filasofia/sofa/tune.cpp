#include "filasofia/sofa/tune.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/sofa/sofa_world.h"

namespace filasofia::sofaengine {

void tune(physics::PhysicsServer& server,
          std::function<void(::sofa::simulation::Node& root, const NodeOf& nodeOf)> change)
{
    if (!change) fail("tune: the function to run must not be empty");
    if (!dynamic_cast<const SofaWorld*>(&server.engine())) fail("tune: the engine 'sofa' is not in use");
    server.tune([change = std::move(change)](physics::PhysicsEngine& engine) {
        SofaWorld& world = dynamic_cast<SofaWorld&>(engine);
        change(world.root(), [&world](BodyId id) { return world.nodeOf(id); });
    });
}

} // namespace filasofia::sofaengine
