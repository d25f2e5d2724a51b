#pragma once

#include "filasofia/scene/scene_def.h"

#include <filesystem>

/// Scene files: JSON with comments whose objects are the Defs. docs/guide/scenes.md describes them.
namespace filasofia::scene {

/// How a scene file is read.
struct SceneFileOptions {
    bool anyFolder = false; ///< files that it names may be outside its folder
};

/// Reads a scene. Throws an Error "FILE:LINE:COLUMN: ..." that names the field, its bound and the value.
SceneDef loadScene(const std::filesystem::path& file, const SceneFileOptions& options = {});

/// The JSON Schema (draft 2020-12) of scene files: editors complete and check a scene by it.
std::string sceneSchema();

} // namespace filasofia::scene
