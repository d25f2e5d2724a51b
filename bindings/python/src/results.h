#pragma once

#include "session.h"
#include "where.h"

namespace filasofia::python {

/// StepReport, StepFlag and RunReport.
void bindReports(nb::module_& module);
/// ContactEvent and the other events.
void bindEvents(nb::module_& module);
/// Tissues, replay, small functions of geometry.
void bindLibrary(nb::module_& module);

/// Where lines of the log go.
void bindLogs(nb::module_& module);

/// Which alternative of Arrived a class of Python stands for; throws an Error if none.
std::size_t alternativeOf(nb::handle eventClass);
nb::object eventObject(Arrived&& event);

} // namespace filasofia::python
