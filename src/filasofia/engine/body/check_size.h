#pragma once

#include "filasofia/core/error.h"

#include <string>

namespace filasofia::engine {

/// Throws an Error if a list of the object does not have `expected` entries.
inline void checkSize(const std::string& object, const char* list, std::size_t size, std::size_t expected)
{
    if (size != expected) fail(object, ": ", list, " must have ", expected, " entries, got ", size);
}

} // namespace filasofia::engine
