#pragma once

#include "filasofia/prefab/child_program.h"

#include <memory>
#include <optional>
#include <string>

namespace filasofia::prefab {

/// The page of `filasofia report` for a session, written by the program beside the trainer and then opened by xdg-open.
/// Nothing is thrown: what goes wrong is said. Main thread.
class SessionReport {
public:
    /// Begins to write the page of this session's file, which is complete, by this program. Returns what to say to the
    /// trainee.
    std::string write(const std::string& session, const std::string& program = programBeside("filasofia"));
    /// To be called for every picture. Something else to say to the trainee, or nothing.
    std::optional<std::string> poll();
    [[nodiscard]] bool writing() const { return program_ != nullptr; }

private:
    std::string page_;
    std::unique_ptr<ChildProgram> program_;
};

} // namespace filasofia::prefab
