#include "filasofia/engine/native_engine.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/world.h"
#include "filasofia/linalg/node_kernels.h"

namespace filasofia::engine {

std::unique_ptr<physics::PhysicsEngine> makeNativeEngine(const NativeEngineDef& def)
{
    validate(def, "native engine");
    return std::make_unique<World>(def);
}

std::vector<std::string> simdTargets() { return linalg::simdTargets(); }

physics::EngineInfo World::info() const
{
    return {.name = "native",
            .version = FILASOFIA_VERSION,
            .repeatable = true,
            .deadline = true,
            .cuts = true,
            .joints = true,
            .energies = true};
}

} // namespace filasofia::engine
