#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace filasofia::visual {

/// A compiled material as its file declares itself. Filament ends the process on a package it does not like: what it
/// would look at is looked at here before, and without Filament.
struct MaterialPackage {
    enum class Kind { Float, Float3, Float4, Int, Bool, Sampler, Other };
    struct Parameter {
        std::string name;
        Kind kind = Kind::Other; ///< Other: a type that cannot be set from here, or an array
    };

    std::vector<std::uint8_t> bytes;
    std::vector<Parameter> parameters; ///< in the order of the file
    bool readsUv = false;              ///< requires texture coordinates

    /// The parameter of this name, or null.
    [[nodiscard]] const Parameter* find(const std::string& name) const;
};

/// As an error calls it: "float3", "sampler2d", ...
const char* nameOf(MaterialPackage::Kind kind);

/// Throws an Error naming the file when it cannot be read, is no package of Filament's version 10 for desktop OpenGL,
/// does not draw surfaces, is damaged, or requires vertex attributes that bodies have not.
MaterialPackage readMaterialPackage(const std::string& file);

/// The same of bytes in memory.
MaterialPackage parseMaterialPackage(std::span<const std::uint8_t> bytes, const std::string& file);

} // namespace filasofia::visual
