#pragma once

#include "where.h"

#include "filasofia/math/pose.h"

#include <cstdint>
#include <vector>

/// Numbers, texts and lists as Python gives them. Each function throws a TypeError for another kind of thing, and
/// filasofia.Error for a value out of bounds.
namespace filasofia::python {

double readNumber(nb::handle value, const Where& where);
/// A whole number in the range of the place and in [low, high], the limits of its type.
std::int64_t readWhole(nb::handle value, const Where& where, std::int64_t low, std::int64_t high);
bool readFlag(nb::handle value, const Where& where);
/// A text, or a path (os.PathLike).
std::string readText(nb::handle value, const Where& where);

/// Whether it is a list, a tuple, an array or another sequence, and no text.
bool isSequence(nb::handle value);
/// Its members, as a list or a tuple; an array becomes a list of Python's own numbers first.
nb::object readSequence(nb::handle value, const Where& where, std::string_view must);
/// The same of few members: a sequence of more than `most`, such as a range, is refused and not copied.
nb::object readShortSequence(nb::handle value, const Where& where, std::string_view must, std::size_t most);
/// The same, with exactly `count` numbers.
void readNumbers(nb::handle value, const Where& where, std::string_view must, double* out, std::size_t count);

bool isFlag(nb::handle value);
bool isWhole(nb::handle value);
bool isNumber(nb::handle value);
bool isText(nb::handle value);

nb::object tupleOf(const double* values, std::size_t count);

} // namespace filasofia::python
