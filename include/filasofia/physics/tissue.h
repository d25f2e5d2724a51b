#pragma once

#include "filasofia/physics/fem_material.h"

#include <string_view>
#include <vector>

namespace filasofia::physics {

/// A tissue of the library: constants that were measured, and what they do not say. `filasofia tissues` prints them
/// all. Measured values differ by factors between people, methods and states of the tissue: take them as a beginning.
struct Tissue {
    std::string_view name;   ///< as tissue() takes it
    std::string_view title;  ///< for people
    FemMaterial material;    ///< for .material; directions of fibres are about the mesh's z axis
    double density = 1000.0; ///< [kg/m^3]
    double lowest = 0.0;     ///< [Pa] range of Young's modulus in the literature
    double highest = 0.0;    ///< [Pa]
    double strength = 0.0;   ///< [Pa] tensile strength as published, for tearingThreshold; 0: unknown
    std::string_view source; ///< of Young's modulus or the constants of the fibres
    std::string_view caveat;
};

/// The whole library, by name.
const std::vector<Tissue>& tissues();

/// A tissue by name. Throws an Error that lists the names if there is none.
const Tissue& tissue(std::string_view name);

} // namespace filasofia::physics
