#pragma once

#include "filasofia/core/error.h"
#include "filasofia/scene/scene_file.h"

#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace filasofia::scene {

/// A folder for scene files, which is removed in the end.
class SceneFolder {
public:
    SceneFolder() { std::filesystem::create_directories(path_); }
    ~SceneFolder() { std::filesystem::remove_all(path_); }
    SceneFolder(const SceneFolder&) = delete;
    SceneFolder& operator=(const SceneFolder&) = delete;

    std::string write(const std::string& name, const std::string& text) const
    {
        const auto file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << text;
        return file.string();
    }
    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
    SceneDef load(const std::string& text) const { return loadScene(write("scene.json", text)); }
    std::string errorOf(const std::string& text) const
    {
        try {
            load(text);
        } catch (const Error& error) {
            const std::string line = error.what();
            const auto at = line.find("scene.json");
            return at == std::string::npos ? line : line.substr(at);
        }
        return "no error";
    }

private:
    static inline int count_ = 0;
    const std::filesystem::path path_ =
        std::filesystem::temp_directory_path() / text("filasofia_scene_", ::getpid(), "_", ++count_);
};

} // namespace filasofia::scene
