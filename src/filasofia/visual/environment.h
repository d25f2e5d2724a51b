#pragma once

#include "filasofia/visual/float3.h"
#include "filasofia/visual/light.h"

#include <array>
#include <vector>

namespace filasofia::visual {

/// Light that arrives from `direction` (unit length), relative to the environment's intensity and blurred as a surface
/// of this perceptual roughness reflects it (0: not blurred).
Float3 radiance(const EnvironmentDef& def, Vec3 direction, double roughness);

/// Six faces one after the other (+X -X +Y -Y +Z -Z, each size x size in OpenGL's layout), for one roughness.
std::vector<Float3> reflectionCube(const EnvironmentDef& def, int size, double roughness);

/// The diffuse light as three bands of spherical harmonics, scaled for filament::IndirectLight::Builder::irradiance.
std::array<Float3, 9> irradianceHarmonics(const EnvironmentDef& def);

} // namespace filasofia::visual
