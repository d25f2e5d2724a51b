#include "filasofia/engine/native_engine.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/engine/world.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <utility>

namespace filasofia::engine {

std::unique_ptr<physics::PhysicsEngine> makeNativeEngine(const NativeEngineDef& def)
{
    validate(def, "native engine");
    return std::make_unique<World>(def);
}

void tune(physics::PhysicsServer& server, std::function<void(Native&)> change)
{
    if (!change) fail("tune: the function to run must be one, got nothing");
    if (!dynamic_cast<const World*>(&server.engine())) fail("tune: the native engine is not in use");
    server.tune([change = std::move(change)](physics::PhysicsEngine& engine) {
        World& world = static_cast<World&>(engine);
        Native native{world.model(), world.state()};
        change(native);
    });
}

} // namespace filasofia::engine
