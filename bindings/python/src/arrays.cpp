#include "arrays.h"

#include "filasofia/core/error.h"

namespace filasofia::python {
namespace {

/// str() of an attribute.
std::string partOf(nb::handle value, const char* name) { return wordsOf(nb::object(value.attr(name))); }

} // namespace

nb::object readArray(nb::handle value, const char* object, std::size_t columns, bool whole)
{
    const nb::module_ numpy = nb::module_::import_("numpy");
    nb::object array;
    try {
        array = numpy.attr("asarray")(value);
    } catch (nb::python_error& problem) { // a list of lists of different lengths
        if (!problem.matches(PyExc_ValueError) && !problem.matches(PyExc_TypeError)) throw;
        failType({.name = object}, "must be an array of numbers", value);
    }
    const std::string kind = partOf(nb::object(array.attr("dtype")), "kind");
    if (kind != "i" && kind != "u" && (whole || kind != "f")) {
        const std::string type = partOf(array, "dtype");
        throw nb::type_error(
            text(object, " must be an array of ", whole ? "whole numbers" : "real numbers", ", got an array of ", type)
                .c_str());
    }
    const bool flat = columns == 1;
    const std::size_t dimensions = nb::cast<std::size_t>(array.attr("ndim"));
    const bool right = dimensions == (flat ? 1u : 2u) &&
                       (flat || nb::cast<std::size_t>(nb::object(array.attr("shape")[1])) == columns);
    if (!right)
        fail(object, " must have the shape ", flat ? "(n,)" : text("(n, ", columns, ")"), ", got ",
             partOf(array, "shape"));
    return numpy.attr("ascontiguousarray")(array, whole ? "int64" : "float64");
}

} // namespace filasofia::python
