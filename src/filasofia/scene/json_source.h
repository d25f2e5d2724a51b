#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <list>
#include <string>
#include <string_view>
#include <unordered_map>

/// The files of a scene as JSON whose values know their lines.
namespace filasofia::scene {

using Json = nlohmann::json;

/// A file that was read. Its folder is where the names in it are looked for.
struct SourceFile {
    std::filesystem::path path;
    std::string shown; ///< as errors name it
    Json root;
};

/// Reads files and keeps them; the address of a value is its name.
class JsonSources {
public:
    /// Throws an Error "FILE:LINE:COLUMN: ..." if it is no JSON, nested more than 64 deep, or has a member twice.
    const SourceFile& read(const std::filesystem::path& path, std::string shown);
    /// "FILE:LINE:COLUMN" of a value of one of the files.
    [[nodiscard]] std::string placeOf(const Json& value) const;
    /// The file of a value.
    [[nodiscard]] const SourceFile& fileOf(const Json& value) const;

private:
    friend class PlaceFinder;
    struct Position {
        const SourceFile* file = nullptr;
        int line = 0;
        int column = 0;
    };

    std::list<SourceFile> files_;
    std::unordered_map<const Json*, Position> positions_;
};

} // namespace filasofia::scene
