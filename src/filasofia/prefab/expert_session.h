#pragma once

#include "filasofia/metric/session.h"
#include "filasofia/prefab/child_program.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// The expert's session of a case and seed: a file or, if there is none, what this program's own expert does without a
/// window, beside the trainer, which makes the file. Nothing is thrown: what goes wrong is said. Main thread.
class ExpertSession {
public:
    /// Takes the file or starts the expert. `words` are those of the trainer that say what to play. Returns what to say
    /// to the trainee; nothing if there is a file.
    std::string find(const std::string& file, std::vector<std::string> words);
    /// To be called for every picture: the session, once.
    std::optional<metric::Session> poll();
    /// What to say to the trainee, if it has changed since the last call.
    std::optional<std::string> news();

private:
    std::string file_, part_;
    std::optional<metric::Session> found_;
    std::optional<std::string> said_;
    std::unique_ptr<ChildProgram> expert_;
};

} // namespace filasofia::prefab
