#pragma once

#include <compare>
#include <cstdint>

namespace filasofia {

/// Names an attachment of one simulation from outside its engine; another simulation gives the same numbers. Numbers
/// are given once and never used again; 0 names none.
struct AttachmentId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(AttachmentId, AttachmentId) = default;
};

} // namespace filasofia
