#pragma once

#include "filasofia/visual/float3.h"
#include "filasofia/visual/light.h"

#include <array>
#include <vector>

namespace filasofia::visual {

/// Light that arrives from `direction` (unit length), blurred as a surface of this perceptual roughness mirrors it
/// (0: not blurred), relative to the environment's intensity.
Float3 radiance(const EnvironmentDef& def, Vec3 direction, double roughness);

/// One face after the other (+X -X +Y -Y +Z -Z, each size x size as OpenGL lays them out), for one roughness.
std::vector<Float3> reflectionCube(const EnvironmentDef& def, int size, double roughness);

/// The diffuse light as three bands of spherical harmonics, scaled as filament::IndirectLight::Builder::irradiance
/// wants it.
std::array<Float3, 9> irradianceHarmonics(const EnvironmentDef& def);

} // namespace filasofia::visual
