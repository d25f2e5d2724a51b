#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/scene/scene_file.h"

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

// The input is a scene file, in a folder of its own.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    static const std::filesystem::path folder = [] {
        const auto made = std::filesystem::path("/dev/shm") / ("filasofia_scene_fuzz_" + std::to_string(getpid()));
        std::filesystem::create_directories(made);
        return made;
    }();
    const std::filesystem::path file = folder / "scene.json";
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<long>(size));
    try {
        static_cast<void>(scene::loadScene(file));
    } catch (const Error&) {
    }
    std::filesystem::remove(file);
    return 0;
}
