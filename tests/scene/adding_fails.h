#pragma once

#include "filasofia/filasofia.h"
#include "scene_folder.h"

namespace filasofia::scene {

/// What adding a scene says is wrong, from the file's name on. `keep`: its tracker keeps its measures.
inline std::string addingFails(const SceneFolder& folder, const std::string& content, bool keep = false)
{
    try {
        const SceneDef scene = folder.load(content);
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene, {.keep = keep}));
    } catch (const Error& error) {
        const std::string line = error.what();
        const auto at = line.find("scene.json:");
        return at == std::string::npos ? line : line.substr(at);
    }
    return "no error";
}

} // namespace filasofia::scene
