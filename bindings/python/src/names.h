#pragma once

#include <set>
#include <string>
#include <string_view>

/// What things of C++ are called in Python.
namespace filasofia::python {

/// "youngModulus" -> "young_modulus"; a word of Python's grammar gets an underscore behind it ("from_").
std::string snakeCase(std::string_view camel);

/// Python's names of our fields and functions: only these are rewritten by pythonic().
void setOwnNames(std::set<std::string> names);

/// A line of an Error, in which the names of fields and functions are those of Python. What is in quotes (a user's
/// name, a file) stays, and so does every word that is no name of ours.
std::string pythonic(std::string_view line);

} // namespace filasofia::python
