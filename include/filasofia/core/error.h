#pragma once

#include "filasofia/core/text.h"

#include <stdexcept>
#include <utility>

namespace filasofia {

/// What is wrong with a user's input, in one line that names object, field, bound and value (or file and line).
class Error : public std::runtime_error {
public:
    explicit Error(std::string line) : std::runtime_error(oneLine(std::move(line))) {}
};

/// Throws an Error made of the parts: fail("body '", name, "': density must be > 0 kg/m^3, got ", density).
template <class... Parts> [[noreturn]] void fail(const Parts&... parts) { throw Error(text(parts...)); }

} // namespace filasofia
