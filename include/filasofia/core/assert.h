#pragma once

namespace filasofia {
/// Prints the condition that does not hold and aborts. Called by FILASOFIA_ASSERT only.
[[noreturn]] void assertionFailed(const char* condition, const char* file, int line) noexcept;
} // namespace filasofia

/// For a caller's bug, never for a user's input: the program stops here. Active in every build; keep it out of inner
/// loops.
#define FILASOFIA_ASSERT(condition)                                                                                    \
    ((condition) ? void(0) : ::filasofia::assertionFailed(#condition, __FILE__, __LINE__))
