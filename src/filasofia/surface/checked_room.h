#pragma once

#include "filasofia/core/validate.h"
#include "filasofia/geometry/box.h"

#include <string>

namespace filasofia::surface {

/// Throws an Error that names the object if the Def is wrong, or has no room, or one without a size. `meaning`: what
/// the room is for.
template <class Def> void validateWithRoom(const Def& def, const std::string& object, const char* meaning)
{
    if (def.room == geometry::Box{}) // the default, which has infinite corners
        fail(object, ": room must be given, with room.low < room.high in every axis; ", meaning);
    validate(def, object);
    const Vec3 size = def.room.high - def.room.low;
    if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0))
        fail(object, ": room.high must be > room.low in every axis, got a room of ", size.x, " x ", size.y, " x ",
             size.z, " m");
}

} // namespace filasofia::surface
