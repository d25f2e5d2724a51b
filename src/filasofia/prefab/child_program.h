#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// A program that works beside this one, started without a shell. Nothing waits for it; its output is discarded, and
/// what it says about errors is kept.
class ChildProgram {
public:
    /// `program` is a file, or a name to be found on PATH. Throws an Error if the system cannot start it.
    ChildProgram(const std::string& program, const std::vector<std::string>& words);
    /// Kills it if it is still at work.
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    ChildProgram& operator=(const ChildProgram&) = delete;

    /// Nothing while it is at work; then an empty string if it ended well, else why not: the last line of its standard
    /// error, or its exit code. Returns at once.
    [[nodiscard]] std::optional<std::string> ended();
    /// Lets it go on when this object ends.
    void leave() { left_ = true; }

private:
    [[nodiscard]] std::string lastError() const;

    pid_t process_ = -1;
    int errors_ = -1; ///< a file in memory
    bool left_ = false;
    std::optional<std::string> result_;
};

/// The program of this name beside the one that runs, or just the name if there is none.
std::string programBeside(const std::string& name);

} // namespace filasofia::prefab
