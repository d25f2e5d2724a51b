#include "filasofia/sofa/load.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/sofa/loaded_world.h"
#include "filasofia/sofa/sofa_process.h"

namespace filasofia::sofaengine {

LoadedScene load(physics::PhysicsServer& server, const LoadDef& def)
{
    validate(def, "LoadDef");
    if (!server.bodies().empty()) fail(def.file, ": a scene of SOFA must come before all bodies");
    LoadedScene scene;
    const std::lock_guard<std::recursive_mutex> lock(sofaMutex());
    startSofa();
    auto root = loadGraph(def);
    scene.dt = root->getDt();
    scene.gravity = def.unit * fromSofa(root->getGravity());
    const std::vector<LoadedItem> items = itemsOf(*root, def.unit, scene.left);
    server.useEngine(std::make_unique<LoadedWorld>(root, items, def));
    for (const LoadedItem& each : items)
        scene.bodies.push_back(
            {each.name, std::visit([&](const auto& body) { return server.add(body); }, each.def), each.picture});
    server.setGravity(scene.gravity);
    return scene;
}

bool isLoadedScene(const physics::PhysicsEngine& engine)
{
    return dynamic_cast<const LoadedWorld*>(&engine) != nullptr;
}

} // namespace filasofia::sofaengine
