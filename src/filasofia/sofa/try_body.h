#pragma once

#include "filasofia/physics/commands.h"

namespace filasofia::sofaengine {

/// Makes the body once in a graph of its own and takes it down again, so that what SOFA cannot make is known where the
/// body is added and not in a step. Throws an Error that names the body, with what SOFA says.
void tryBody(const physics::BodyDef& def, const physics::BuiltBody& body, const physics::ContactMethod& method);

} // namespace filasofia::sofaengine
