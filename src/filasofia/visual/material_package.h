#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace filasofia::visual {

/// A compiled material as its file describes it. Filament ends the process if a package is invalid, so the parts that
/// Filament reads are checked here first, without Filament.
struct MaterialPackage {
    enum class Kind { Float, Float3, Float4, Int, Bool, Sampler, Other };
    struct Parameter {
        std::string name;
        Kind kind = Kind::Other; ///< Other: an array, or a type that cannot be set from here
    };

    std::vector<std::uint8_t> bytes;
    std::vector<Parameter> parameters; ///< in the order of the file
    bool readsUv = false;              ///< requires texture coordinates

    /// The parameter of this name, or null.
    [[nodiscard]] const Parameter* find(const std::string& name) const;
};

/// The name in errors: "float3", "sampler2d", ...
const char* nameOf(MaterialPackage::Kind kind);

/// Throws an Error naming the file if it cannot be read, is not a package of Filament's version 10 for desktop OpenGL,
/// does not draw surfaces, is damaged, or requires vertex attributes that bodies do not have.
MaterialPackage readMaterialPackage(const std::string& file);

/// The same for bytes in memory.
MaterialPackage parseMaterialPackage(std::span<const std::uint8_t> bytes, const std::string& file);

} // namespace filasofia::visual
