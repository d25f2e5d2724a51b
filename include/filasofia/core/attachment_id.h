#pragma once

#include <compare>
#include <cstdint>

namespace filasofia {

/// Names an attachment of one simulation outside its engine; another simulation uses the same numbers. A number is
/// never reused; 0 names no attachment.
struct AttachmentId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(AttachmentId, AttachmentId) = default;
};

} // namespace filasofia
