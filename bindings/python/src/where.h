#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/fields.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h> // wherever a text crosses: without it the cast fails when it is made

#include <cstddef>
#include <string>
#include <string_view>

namespace filasofia::python {

namespace nb = nanobind;

/// The place of a value that is read from Python, for errors: a chain from the value outwards. It lives on the stack.
struct Where {
    const Where* outer = nullptr; ///< null: `name` is the object, and no field
    std::string_view name = {};   ///< the field's; empty for a member of a list
    std::size_t index = 0;        ///< in a list
    Range range = {};
    std::string_view unit = {};

    /// "soft body 'liver': material.young_modulus", "FemMaterial: regions[2].where".
    [[nodiscard]] std::string text() const;
    [[nodiscard]] Where at(std::size_t i) const { return {.outer = this, .index = i, .range = range, .unit = unit}; }
};

/// An Error with the words of Python: its value is the user's, and no name of C++ is in it.
class PythonError : public Error {
public:
    using Error::Error;
};

/// Throws filasofia.Error: "<place> <must>, got <value>".
[[noreturn]] void failValue(const Where& where, std::string_view must, nb::handle got);
/// Throws a TypeError of the same form.
[[noreturn]] void failType(const Where& where, std::string_view must, nb::handle got);

/// "a TetMesh", "an Extract".
std::string withArticle(std::string_view noun);

/// str() of a value.
std::string wordsOf(nb::handle value);

/// The value as errors print it: its repr, shortened; for a class that a value was expected of, the class.
std::string shown(nb::handle value);

} // namespace filasofia::python
