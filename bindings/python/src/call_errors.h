#pragma once

#include <nanobind/nanobind.h>

namespace filasofia::python {

namespace nb = nanobind;

/// Makes one line of what nanobind says about wrong arguments, in every function of the module and its classes:
/// filasofia._call_errors.explain() writes it. Call it when all of them are there.
void explainWrongArguments(nb::module_& module);

} // namespace filasofia::python
