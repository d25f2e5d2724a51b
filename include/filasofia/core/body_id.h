#pragma once

#include <compare>
#include <cstdint>

namespace filasofia {

/// Names a body of one simulation outside its engine; another simulation uses the same numbers. A number is never
/// reused; 0 names no body.
struct BodyId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(BodyId, BodyId) = default;
};

} // namespace filasofia
