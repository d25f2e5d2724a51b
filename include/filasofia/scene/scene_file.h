#pragma once

#include "filasofia/scene/scene_def.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Scene files: JSON with comments whose objects are the Defs. docs/guide/scenes.md describes them.
namespace filasofia::scene {

/// How a scene file is read.
struct SceneFileOptions {
    bool anyFolder = false; ///< files that it names may be outside its folder
};

/// Reads a scene. Throws an Error "FILE:LINE:COLUMN: ..." that names the field, its bound and the value.
SceneDef loadScene(const std::filesystem::path& file, const SceneFileOptions& options = {});

/// How a scene file is written.
struct SaveOptions {
    bool overwrite = false; ///< files in FILE_files that have the names of new ones are replaced
};

/// Writes a scene as a file that loadScene() reads back with the same bits. Meshes in memory, and files that are
/// neither in its folder nor come with Filasofia, become files in the folder FILE_files beside it. Throws an Error if a
/// file cannot be written, if one of FILE_files is there already, or if the scene holds what a file cannot; in the
/// last two cases nothing has been written.
void saveScene(const SceneDef& scene, const std::filesystem::path& file, const SaveOptions& options = {});

/// What a recording was made from, as a scene.
struct RecordedScene {
    SceneDef scene = {};
    std::vector<std::string> notes = {};    ///< what a scene cannot hold, a sentence each
    std::vector<std::uint64_t> hashes = {}; ///< of the state after each step; 0: not recorded
};

/// Makes a scene of a recording: its bodies, their motions as keys, its commands at their times, its picture. If there
/// are no notes and the run was headless, the scene has the same states, bit for bit. Throws an Error that names the
/// file if it is no recording, or holds no step that can be repeated.
RecordedScene sceneOf(const std::filesystem::path& recording);

/// The JSON Schema (draft 2020-12) of scene files: editors complete and check a scene by it.
std::string sceneSchema();

} // namespace filasofia::scene
