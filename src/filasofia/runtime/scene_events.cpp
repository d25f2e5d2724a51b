#include "filasofia/runtime/scene_events.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/validate.h"
#include "filasofia/record/json_limits.h"
#include "filasofia/record/json_reader.h"
#include "filasofia/record/json_writer.h"

#include <cstring>
#include <filesystem>
#include <fstream>

namespace filasofia::runtime {
namespace {

/// Calls take(file) for every file that a value names, at any depth.
template <class T, class Take> void forEachFile(const T& value, Take& take)
{
    if constexpr (std::is_same_v<T, visual::TextureFile>)
        take(value.file);
    else if constexpr (record::kIsVariant<T>)
        std::visit([&](const auto& held) { forEachFile(held, take); }, value);
    else if constexpr (record::kIsVector<T>)
        for (const auto& each : value) forEachFile(each, take);
    else if constexpr (record::kIsOptional<T>) {
        if (value) forEachFile(*value, take);
    } else if constexpr (HasFields<T>) {
        if constexpr (std::is_same_v<T, visual::CustomMaterial>) take(value.file);
        forEachField<T>([&](const auto& each) { forEachFile(value.*(each.member), take); });
    }
}

} // namespace

record::SceneRecord recordOf(const SceneEvent& event)
{
    record::JsonWriter writer;
    record::SceneRecord out;
    out.words = writer.write(event).dump(-1, ' ', false, record::Json::error_handler_t::replace);
    for (const record::Mesh& mesh : writer.takeNewMeshes())
        out.surfaces.push_back(std::get<record::TriangleMesh>(mesh));
    return out;
}

SceneEvent eventOf(const record::SceneRecord& record)
{
    record::JsonReader reader;
    reader.missing = record.missing;
    for (const auto& surface : record.surfaces) reader.meshes.emplace_back(surface);
    SceneEvent event;
    reader.read(record::parsed(record.words), event, record::Place{nullptr, "scene"});
    std::visit([](const auto& held) { validate(held, "scene"); }, event);
    return event;
}

std::vector<std::string> filesOf(const SceneEvent& event)
{
    std::vector<std::string> files;
    const auto take = [&](const std::string& file) { files.push_back(file); };
    forEachFile(event, take);
    return files;
}

std::optional<SceneFile> digested(const std::string& file)
{
    std::error_code problem;
    // A recording may name anything: a device never ends, and opening a pipe waits for its writer.
    if (!std::filesystem::is_regular_file(file, problem)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    SceneFile out{.file = file};
    Hasher hasher;
    for (std::uint64_t word = 0;; word = 0) {
        in.read(reinterpret_cast<char*>(&word), sizeof word);
        if (in.gcount() == 0) break;
        out.bytes += static_cast<std::uint64_t>(in.gcount());
        hasher.add(word);
    }
    if (in.bad()) return std::nullopt;
    hasher.add(out.bytes);
    out.digest = hasher.value();
    return out;
}

} // namespace filasofia::runtime
