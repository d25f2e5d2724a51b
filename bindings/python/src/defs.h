#pragma once

#include "convert.h"

#include "filasofia/physics/commands.h"
#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/runtime/stepped_run.h"

/// All Defs, found from those that a user can give by following the fields() lists.
namespace filasofia::python {

/// schema(), check_field(), defaults(): what the package makes the classes of.
void bindDefs(nb::module_& module);

/// Reads a Def that the caller knows the kind of; `object` is what errors begin with.
template <class T> T readDef(nb::handle value, std::string_view object)
{
    return Convert<T>::read(value, Where{.name = object});
}

} // namespace filasofia::python
