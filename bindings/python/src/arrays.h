#pragma once

#include "where.h"

#include "filasofia/math/vec3.h"

#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

/// NumPy arrays of the engine's lists, and back. NumPy is imported when the first array is made.
namespace filasofia::python {

/// Where the rows begin. Also if there are none: an array of nothing would be a new one, which can be written.
template <class As, class Row> const As* beginOf(const std::vector<Row>& rows)
{
    static constexpr double nothing = 0.0;
    return reinterpret_cast<const As*>(rows.empty() ? static_cast<const void*>(&nothing) : rows.data());
}

/// A read-only array without a copy: (n, columns), or (n,) for one column. `owner` is what keeps the list alive.
template <class Number, std::size_t columns, class Row>
nb::object rowsOf(const std::vector<Row>& rows, nb::handle owner)
{
    static_assert(sizeof(Row) == columns * sizeof(Number));
    const auto* data = beginOf<Number>(rows);
    using Array = nb::ndarray<nb::numpy, const Number, nb::c_contig>;
    if constexpr (columns == 1) return nb::cast(Array(data, {rows.size()}, owner));
    return nb::cast(Array(data, {rows.size(), columns}, owner));
}

/// A read-only structured array without a copy; `type` is the NumPy dtype of one row.
template <class Row> nb::object recordsOf(const std::vector<Row>& rows, nb::handle type, nb::handle owner)
{
    using Bytes = nb::ndarray<nb::numpy, const std::uint8_t, nb::c_contig>;
    const auto* data = beginOf<std::uint8_t>(rows);
    return nb::cast(Bytes(data, {rows.size() * sizeof(Row)}, owner)).attr("view")(type);
}

/// A new array of this shape, which takes the numbers over.
template <class Number> nb::object arrayOf(std::vector<Number> numbers, std::initializer_list<std::size_t> shape)
{
    auto* kept = new std::vector<Number>(std::move(numbers));
    const nb::capsule owner(kept, [](void* held) noexcept { delete static_cast<std::vector<Number>*>(held); });
    return nb::cast(nb::ndarray<nb::numpy, Number>(kept->data(), shape, owner));
}

/// A new array of the three numbers.
inline nb::object vectorOf(const Vec3& value)
{
    return nb::cast(nb::ndarray<nb::numpy, const double>(&value.x, {3}), nb::rv_policy::copy);
}

/// The array that NumPy makes of a user's value, of the given type, contiguous. Throws a TypeError unless its numbers
/// are real (whole, if `whole`), and filasofia.Error unless it is (n, columns), or (n,) for one column.
nb::object readArray(nb::handle value, const char* object, std::size_t columns, bool whole);

/// Throws filasofia.Error: a whole number of an array is too large for an index.
[[noreturn]] void failBelow(const char* object, nb::handle got);

/// The rows of a user's array, copied.
template <class Row, class Number, std::size_t columns> std::vector<Row> readRows(nb::handle value, const char* object)
{
    static_assert(sizeof(Row) == columns * sizeof(Number));
    constexpr bool whole = std::is_integral_v<Number>;
    using Wide = std::conditional_t<whole, std::int64_t, double>;
    const nb::object array = readArray(value, object, columns, whole);
    const auto view = nb::cast<nb::ndarray<const Wide, nb::c_contig, nb::device::cpu>>(array);
    std::vector<Row> rows(view.shape(0));
    auto* out = reinterpret_cast<Number*>(rows.data());
    for (std::size_t i = 0; i < view.size(); ++i) {
        if constexpr (whole)
            if (view.data()[i] < std::numeric_limits<int>::min() || view.data()[i] > std::numeric_limits<int>::max())
                failBelow(object, nb::int_(view.data()[i]));
        out[i] = static_cast<Number>(view.data()[i]);
    }
    return rows;
}

} // namespace filasofia::python
