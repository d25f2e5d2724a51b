#pragma once

#include <exception>
#include <optional>
#include <string>
#include <utility>

namespace filasofia {

/// Calls a user's function: whatever it throws, of whatever type, goes no further. Returns what that was, in words for
/// an error line; nothing if the function returned.
template <class Call> [[nodiscard]] std::optional<std::string> guardedCall(Call&& call)
{
    try {
        std::forward<Call>(call)();
    } catch (const std::exception& problem) {
        return problem.what();
    } catch (...) {
        return "it threw something that is no std::exception";
    }
    return std::nullopt;
}

} // namespace filasofia
