#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <string>

namespace filasofia::physics {

/// Throws an Error unless neighbouring points of a line are apart and it folds nowhere: it turns by less than 168
/// degrees at each. `object` and `list` name the points in the message. A ring's last point is joined to its first.
void checkLine(std::span<const Vec3> points, bool closed, const std::string& object, const char* list);

} // namespace filasofia::physics
