#pragma once

#include <exception>
#include <optional>
#include <string>
#include <utility>

namespace filasofia {

/// Calls a user's function and catches whatever it throws, of any type. Returns a description of that for an error
/// line, or nothing if the function returned.
template <class Call> [[nodiscard]] std::optional<std::string> guardedCall(Call&& call)
{
    try {
        std::forward<Call>(call)();
    } catch (const std::exception& problem) {
        return problem.what();
    } catch (...) {
        return "it threw something that is not a std::exception";
    }
    return std::nullopt;
}

} // namespace filasofia
