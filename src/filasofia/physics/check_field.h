#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/collision_def.h"

namespace filasofia::physics {

/// Throws an Error unless `element` is one of a body's `count` elements; `field` names it in the message.
inline void checkElement(int element, std::size_t count, const std::string& field)
{
    if (element < 0 || static_cast<std::size_t>(element) >= count)
        fail(field, " must be in [0, ", count, "), got ", element);
}

/// Whether there is a mesh, or at least the name of a file.
inline bool isGiven(const TriangleMeshSource& source)
{
    const auto* file = std::get_if<std::string>(&source);
    return !file || !file->empty();
}

} // namespace filasofia::physics
