#pragma once

#include "filasofia/core/error.h"

#include <string>

namespace filasofia::engine {

/// Throws an Error unless a list of the object has as many entries.
inline void checkSize(const std::string& object, const char* list, std::size_t size, std::size_t expected)
{
    if (size != expected) fail(object, ": ", list, " must have ", expected, " entries, got ", size);
}

} // namespace filasofia::engine
