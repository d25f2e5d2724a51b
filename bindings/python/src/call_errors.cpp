#include "call_errors.h"

#include "where.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <utility>

namespace filasofia::python {
namespace {

using Call = PyObject* (*)(PyObject*, PyObject* const*, size_t, PyObject*);

// nanobind has a handful of functions that call a bound one, and each bound one points to its own. We put ours between:
// an error costs a look at its message, a call that succeeds one jump (1 ns of the 0.5 us of step()).
constexpr std::size_t kMost = 8;
std::array<Call, kMost> theirs = {};

/// Replaces nanobind's message, several lines of signatures and types, if that is the error.
void explain(PyObject* function, PyObject* const* arguments, size_t flaggedCount, PyObject* names)
{
    nb::python_error problem; // takes the error
    try {
        const nb::object words = nb::str(problem.value());
        if (std::strstr(nb::cast<const char*>(words), "(): incompatible function arguments.") == nullptr)
            return problem.restore();
        const std::size_t count = flaggedCount & 0xffffffffU; // nanobind has flags of its own above, beside Python's
        nb::list given;
        for (std::size_t i = 0; i < count; ++i) given.append(nb::handle(arguments[i]));
        nb::dict named;
        if (names != nullptr)
            for (std::size_t i = 0; i < nb::len(nb::handle(names)); ++i)
                named[nb::handle(names)[i]] = nb::handle(arguments[count + i]);
        const nb::object line =
            nb::module_::import_("filasofia._call_errors").attr("explain")(nb::handle(function), given, named);
        PyErr_SetObject(PyExc_TypeError, line.ptr());
    } catch (const std::exception&) { // a text that fails, the end of the interpreter, no package
        problem.restore();
    }
}

template <std::size_t i>
PyObject* call(PyObject* function, PyObject* const* arguments, size_t flaggedCount, PyObject* names)
{
    PyObject* const result = theirs[i](function, arguments, flaggedCount, names);
    if (!result && PyErr_ExceptionMatches(PyExc_TypeError)) explain(function, arguments, flaggedCount, names);
    return result;
}

template <std::size_t... i> constexpr std::array<Call, sizeof...(i)> makeOurs(std::index_sequence<i...>)
{
    return {&call<i>...};
}
constexpr std::array<Call, kMost> ours = makeOurs(std::make_index_sequence<kMost>());

void wrap(nb::handle function)
{
    // Python's vectorcall protocol lets each object have such a pointer; nanobind's follows the head. Its class tells
    // the pointer's value under this name, so that we need not trust in that: if it is elsewhere, messages stay long.
    Call& pointer = *reinterpret_cast<Call*>(reinterpret_cast<char*>(function.ptr()) + sizeof(PyVarObject));
    if (nb::cast<std::intptr_t>(function.attr("__vectorcalloffset__")) != reinterpret_cast<std::intptr_t>(pointer))
        return;
    for (std::size_t i = 0; i < kMost; ++i) {
        if (pointer == ours[i]) return; // another name of a function
        if (theirs[i] == nullptr) theirs[i] = pointer;
        if (theirs[i] != pointer) continue;
        pointer = ours[i];
        return;
    }
}

/// Wraps the functions among the members of a module or a class, and those of the classes among them.
void wrapMembers(nb::handle scope)
{
    const nb::object members = scope.attr("__dict__").attr("copy")();
    for (const nb::handle member : members.attr("values")()) {
        const std::string kind =
            wordsOf(nb::handle(reinterpret_cast<PyObject*>(Py_TYPE(member.ptr()))).attr("__name__"));
        if (kind == "nb_func" || kind == "nb_method")
            wrap(member);
        else if (PyType_Check(member.ptr()) && nb::hasattr(member, "__module__") &&
                 wordsOf(member.attr("__module__")) ==
                     wordsOf(scope.attr(nb::isinstance<nb::module_>(scope) ? "__name__" : "__module__")))
            wrapMembers(member);
    }
}

} // namespace

void explainWrongArguments(nb::module_& module) { wrapMembers(module); }

} // namespace filasofia::python
