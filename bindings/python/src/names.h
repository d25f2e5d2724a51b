#pragma once

#include <string>
#include <string_view>

/// What things of C++ are called in Python.
namespace filasofia::python {

/// "youngModulus" -> "young_modulus"; a word of Python's grammar gets an underscore behind it ("from_").
std::string snakeCase(std::string_view camel);

/// A line of an Error, in which the names of fields and functions are those of Python. What is in quotes (a user's
/// name, a file) stays, and so do the names of files that are not; an apostrophe is no quote.
std::string pythonic(std::string_view line);

} // namespace filasofia::python
