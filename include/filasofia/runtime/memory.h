#pragma once

#include <any>
#include <functional>
#include <map>
#include <string>

namespace filasofia::runtime {

/// What a part of a simulator remembers from step to step beside physics: how far a task is, what jaws hold. Saved
/// states have a copy of it (runtime/stepped_run.h). Simulation::remember() takes it.
struct Memory {
    std::string of = {};                               ///< "task 'biopsy'", the same wherever a state may be restored
    std::function<std::any()> save = {};               ///< a copy of it; nothing if the part is gone
    std::function<void(const std::any&)> restore = {}; ///< returns to such a copy; must not throw
    /// Throws an Error if the part cannot return to a copy, before anything has changed. Nothing: the state does not
    /// know the part, and restore() gets nothing, too. Not given: such a state is an Error.
    std::function<void(const std::any&)> check = {};
};

using Memories = std::map<std::string, std::any>; ///< copies, by Memory::of

} // namespace filasofia::runtime
