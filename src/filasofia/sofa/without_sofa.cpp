#include "filasofia/core/error.h"
#include "filasofia/sofa/load.h"
#include "filasofia/sofa/sofa_engine.h"
#include "filasofia/sofa/tune.h"

// The room of a program that was built without SOFA.
namespace filasofia::sofaengine {

bool isBuiltIn() { return false; }

std::unique_ptr<physics::PhysicsEngine> makeSofaEngine(const SofaEngineDef& /*def*/)
{
    fail("engine 'sofa' is not built in: install SOFA 25.12 and build again with -DFILASOFIA_SOFA=ON "
         "(docs/guide/sofa.md)");
}

LoadedScene load(physics::PhysicsServer& /*server*/, const LoadDef& def)
{
    fail(def.file, ": SOFA is not built in: install SOFA 25.12 and build again with -DFILASOFIA_SOFA=ON "
                   "(docs/guide/sofa.md)");
}

bool isLoadedScene(const physics::PhysicsEngine& /*engine*/) { return false; }

void tune(physics::PhysicsServer& /*server*/,
          // The room `sofa` keeps it. NOLINTNEXTLINE(performance-unnecessary-value-param)
          std::function<void(::sofa::simulation::Node& root, const NodeOf& nodeOf)> /*change*/)
{
    fail("tune: the engine 'sofa' is not in use");
}

} // namespace filasofia::sofaengine
