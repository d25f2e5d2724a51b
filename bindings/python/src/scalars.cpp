#include "scalars.h"

#include "filasofia/core/error.h"

#include <string_view>

namespace filasofia::python {
namespace {

/// NumPy's bool is no bool of Python, and to ask NumPy would be to import it.
bool isNumpyFlag(nb::handle value)
{
    const nb::object name = nb::handle(Py_TYPE(value.ptr())).attr("__name__");
    const nb::object module_ = nb::handle(Py_TYPE(value.ptr())).attr("__module__");
    if (!nb::isinstance<nb::str>(name) || !nb::isinstance<nb::str>(module_)) return false;
    const std::string_view word = nb::cast<const char*>(name);
    return std::string_view(nb::cast<const char*>(module_)) == "numpy" && (word == "bool" || word == "bool_");
}

std::string must(const Where& where, std::string_view kind)
{
    const std::string bound = where.range.text(where.unit); // "must be > 0 Pa"
    return text("must be ", kind, std::string_view(bound).substr(std::string_view("must be").size()));
}

} // namespace

bool isFlag(nb::handle value) { return PyBool_Check(value.ptr()) || isNumpyFlag(value); }
bool isText(nb::handle value) { return PyUnicode_Check(value.ptr()); }
bool isWhole(nb::handle value)
{
    return PyLong_Check(value.ptr()) ? !PyBool_Check(value.ptr()) : PyIndex_Check(value.ptr()) && !isNumpyFlag(value);
}
bool isNumber(nb::handle value)
{
    if (PyFloat_Check(value.ptr())) return true;
    if (isFlag(value) || isText(value)) return false;
    return isWhole(value) || nb::hasattr(value, "__float__");
}

double readNumber(nb::handle value, const Where& where)
{
    double number = 0.0;
    if (PyFloat_Check(value.ptr())) {
        number = PyFloat_AsDouble(value.ptr());
    } else {
        if (!isNumber(value)) failType(where, "must be a number", value);
        const nb::object real = nb::steal(PyNumber_Float(value.ptr()));
        if (!real.is_valid()) {
            const bool large = PyErr_ExceptionMatches(PyExc_OverflowError) != 0;
            PyErr_Clear();
            if (large) failValue(where, where.range.text(where.unit), value);
            failType(where, "must be a number", value);
        }
        number = PyFloat_AsDouble(real.ptr());
    }
    if (!where.range.contains(number)) failValue(where, where.range.refusal(where.unit, number), value);
    return number;
}

std::int64_t readWhole(nb::handle value, const Where& where, std::int64_t low, std::int64_t high)
{
    if (isFlag(value)) failType(where, "must be a whole number (numpy.flatnonzero() makes indices of a mask)", value);
    if (!isWhole(value)) failType(where, "must be a whole number", value);
    const nb::object whole = nb::steal(PyNumber_Index(value.ptr()));
    if (!whole.is_valid()) {
        PyErr_Clear(); // an array, which has an __index__ that fails
        failType(where, "must be a whole number", value);
    }
    int overflow = 0;
    const long long number = PyLong_AsLongLongAndOverflow(whole.ptr(), &overflow);
    if (overflow != 0 || number < low || number > high)
        failValue(where, text("must be a whole number in [", low, ", ", high, "]"), value);
    if (!where.range.contains(static_cast<double>(number))) failValue(where, must(where, "a whole number"), value);
    return number;
}

bool readFlag(nb::handle value, const Where& where)
{
    if (!isFlag(value)) failType(where, "must be True or False", value);
    return PyObject_IsTrue(value.ptr()) == 1;
}

std::string readText(nb::handle value, const Where& where)
{
    nb::object words = nb::borrow(value);
    if (!isText(value) && nb::hasattr(value, "__fspath__")) words = value.attr("__fspath__")();
    if (!isText(words)) failType(where, "must be a text", value);
    Py_ssize_t size = 0;
    const char* letters = PyUnicode_AsUTF8AndSize(words.ptr(), &size);
    if (!letters) {
        PyErr_Clear();
        failValue(where, "must be a text that UTF-8 can hold", value);
    }
    std::string read(letters, static_cast<std::size_t>(size));
    // The system's functions end a name there, and would write another file.
    if (read.find('\0') != std::string::npos) failValue(where, "must be a text without NUL characters", value);
    return read;
}

bool isSequence(nb::handle value)
{
    PyObject* it = value.ptr();
    return PySequence_Check(it) && !PyUnicode_Check(it) && !PyBytes_Check(it) && !PyByteArray_Check(it);
}

nb::object readSequence(nb::handle value, const Where& where, std::string_view must)
{
    if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) return nb::borrow(value);
    if (!isSequence(value)) failType(where, must, value);
    nb::object members = nb::borrow(value);
    if (nb::hasattr(value, "tolist")) members = value.attr("tolist")(); // a thousand times faster than by its members
    if (!isSequence(members)) failType(where, must, value);             // an array of no dimension
    nb::object out = nb::steal(PySequence_List(members.ptr()));
    if (!out.is_valid()) throw nb::python_error();
    return out;
}

nb::object readShortSequence(nb::handle value, const Where& where, std::string_view must, std::size_t most)
{
    if (isSequence(value)) {
        const Py_ssize_t size = PySequence_Size(value.ptr());
        if (size < 0) PyErr_Clear(); // an array of no dimension: readSequence() says so
        if (size > static_cast<Py_ssize_t>(most)) failValue(where, must, value);
    }
    return readSequence(value, where, must);
}

void readNumbers(nb::handle value, const Where& where, std::string_view must, double* out, std::size_t count)
{
    const nb::object members = readShortSequence(value, where, must, count);
    if (nb::len(members) != count) failValue(where, must, value);
    for (std::size_t i = 0; i < count; ++i) {
        const nb::object each = members[i];
        out[i] = readNumber(each, where.at(i));
    }
}

nb::object tupleOf(const double* values, std::size_t count)
{
    nb::object out = nb::steal(PyTuple_New(static_cast<Py_ssize_t>(count)));
    for (std::size_t i = 0; i < count; ++i)
        PyTuple_SetItem(out.ptr(), static_cast<Py_ssize_t>(i), PyFloat_FromDouble(values[i]));
    return out;
}

} // namespace filasofia::python
