#include "arrays.h"

#include "filasofia/core/error.h"

#include <cstddef>
#include <limits>

namespace filasofia::python {
namespace {

constexpr std::size_t kMostRows = 100'000'000; ///< a view of one row may claim any number of them

/// str() of an attribute.
std::string partOf(nb::handle value, const char* name) { return wordsOf(nb::object(value.attr(name))); }

/// The largest numbers of uint64 would be negative ones as int64.
void checkUnsigned(nb::handle array, const char* object)
{
    if (nb::cast<std::size_t>(array.attr("size")) == 0) return;
    const nb::object largest = array.attr("max")();
    if (largest > nb::int_(std::numeric_limits<int>::max())) failBelow(object, nb::int_(largest));
}

} // namespace

void failBelow(const char* object, nb::handle got)
{
    failValue({.name = object}, "must have whole numbers below 2^31", got);
}

nb::object readArray(nb::handle value, const char* object, std::size_t columns, bool whole)
{
    const nb::module_ numpy = nb::module_::import_("numpy");
    if (nb::hasattr(value, "mask") && nb::hasattr(value, "filled")) // asarray() would give what is under the mask
        failType({.name = object}, "must be an array without a mask", value);
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
    if (const auto rows = nb::cast<std::size_t>(nb::object(array.attr("shape")[0])); rows > kMostRows)
        fail(object, " must have at most ", kMostRows, " rows, got ", rows);
    if (kind == "u" && whole) checkUnsigned(array, object);
    return numpy.attr("ascontiguousarray")(array, whole ? "int64" : "float64");
}

} // namespace filasofia::python
