#pragma once

#include "where.h"

#include <string_view>

/// The classes that the package makes in Python (defs.py): one per Def, and the ids. C++ finds them by name.
namespace filasofia::python {

/// Takes the classes, a dict by name, once: at the end of the package's import.
void setClasses(nb::dict classes);
/// The class of this name; throws a RuntimeError if the package has not made it.
nb::handle classOf(std::string_view name);
/// The object is of the class of this name.
bool isOf(nb::handle value, std::string_view name);
/// The name of the Def whose class, or an instance of whose class, this is; empty if it is none.
std::string defName(nb::handle value);

} // namespace filasofia::python
