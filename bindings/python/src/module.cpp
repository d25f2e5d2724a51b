#include "call_errors.h"
#include "defs.h"
#include "frames.h"
#include "meshes.h"
#include "names.h"
#include "results.h"
#include "simulation.h"

#include "filasofia/core/error.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace filasofia::python {
namespace {

/// filasofia.Error, a ValueError: what is wrong with a user's input, in one line, with the names of Python.
void bindError(nb::module_& module)
{
    static PyObject* const type = PyErr_NewExceptionWithDoc(
        "filasofia.Error", "What is wrong with the input, in one line that names object, field, bound and value.",
        PyExc_ValueError, nullptr);
    module.attr("Error") = nb::handle(type);
    nb::register_exception_translator(
        [](const std::exception_ptr& thrown, void* error) {
            try {
                std::rethrow_exception(thrown);
            } catch (const PythonError& problem) {
                PyErr_SetString(static_cast<PyObject*>(error), problem.what());
            } catch (const Error& problem) {
                PyErr_SetString(static_cast<PyObject*>(error), pythonic(problem.what()).c_str());
            }
        },
        type);
}

} // namespace
} // namespace filasofia::python

NB_MODULE(_core, module)
{
    using namespace filasofia::python;
    // A program that ends with simulations in its modules is no leak; what the tests count is in tests/python.
    nb::set_leak_warnings(false);
    watchForks();
    bindError(module);
    bindMeshes(module);
    bindDefs(module);
    bindReports(module);
    bindEvents(module);
    bindLibrary(module);
    bindLogs(module);
    bindFrames(module);
    bindSimulation(module);
    addInstrument(module);
    addClipApplier(module);
    addInstrumentTie(module);
    addEndoscope(module);
    addKnotHands(module);
    addLaparoscopy(module);
    addSpecimenBag(module);
    addSuctionIrrigator(module);
    addUltrasonicShears(module);
    addWireLoop(module);
    module.def("set_own_names", [](const std::vector<std::string>& names) {
        setOwnNames({names.begin(), names.end()});
    });
    module.def("close_all", &closeAll, nb::call_guard<nb::gil_scoped_release>());
    explainWrongArguments(module);
}
