#include "classes.h"

#include "filasofia/core/text.h"

#include <functional>
#include <map>
#include <string>

namespace filasofia::python {
namespace {

/// Borrowed from the package's module, which lives until the interpreter ends.
std::map<std::string, PyObject*, std::less<>>& known()
{
    static std::map<std::string, PyObject*, std::less<>> classes;
    return classes;
}

} // namespace

void setClasses(nb::dict classes)
{
    for (const auto& [name, made] : classes) {
        known()[nb::cast<std::string>(nb::str(name))] = made.ptr();
        Py_INCREF(made.ptr()); // for ever: a user may remove them from the module
    }
}

nb::handle classOf(std::string_view name)
{
    const auto found = known().find(name);
    if (found == known().end())
        throw std::runtime_error(text("filasofia has no class ", name, ": import filasofia first"));
    return found->second;
}

bool isOf(nb::handle value, std::string_view name)
{
    const int is = PyObject_IsInstance(value.ptr(), classOf(name).ptr());
    if (is < 0) throw nb::python_error();
    return is == 1;
}

std::string defName(nb::handle value)
{
    const PyObject* type = PyType_Check(value.ptr()) ? value.ptr() : reinterpret_cast<PyObject*>(Py_TYPE(value.ptr()));
    for (const auto& [name, made] : known())
        if (made == type) return name;
    return {};
}

} // namespace filasofia::python
