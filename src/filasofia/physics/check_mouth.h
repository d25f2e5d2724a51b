#pragma once

#include "filasofia/physics/mouth.h"

#include <string>

namespace filasofia::physics {

/// Throws an Error that begins with `object` if the mouth is not one of a body with so many elements.
void check(const Mouth& mouth, std::size_t elements, const std::string& object);

} // namespace filasofia::physics
