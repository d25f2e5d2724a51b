#pragma once

#include "filasofia/math/vec3.h"
#include "filasofia/visual/color.h"
#include "filasofia/visual/texture.h"

#include <array>
#include <vector>

namespace filasofia::visual {

/// double sets a `float`, int an `int`, bool a `bool`, Color and Vec3 a `float3`, four numbers a `float4`, Texture a
/// `sampler2d` (white if it is NoTexture).
using ParameterValue = std::variant<double, int, bool, Color, Vec3, std::array<double, 4>, Texture>;

struct MaterialParameter {
    std::string name = {};
    ParameterValue value = 0.0; ///< finite

    friend bool operator==(const MaterialParameter&, const MaterialParameter&) = default;
};

constexpr auto fields(const MaterialParameter*)
{
    return describe("MaterialParameter", field("name", &MaterialParameter::name, "as the material calls it"),
                    field("value", &MaterialParameter::value, "its value, of the material's type"));
}

/// A user's own material, compiled by Filament's matc 1.9 for desktop OpenGL. It may require the attributes position,
/// tangents, color (blood, burn, wetness), uv0 and custom0 (position at rest). Parameters that are not set are 0, or
/// white.
struct CustomMaterial {
    std::string file = {}; ///< a .filamat; read once per server, when it is first named
    std::vector<MaterialParameter> parameters = {};

    friend bool operator==(const CustomMaterial&, const CustomMaterial&) = default;
};

constexpr auto fields(const CustomMaterial*)
{
    return describe("CustomMaterial", field("file", &CustomMaterial::file, "a compiled .filamat"),
                    field("parameters", &CustomMaterial::parameters, "by name"));
}

} // namespace filasofia::visual
