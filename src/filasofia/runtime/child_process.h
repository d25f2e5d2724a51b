#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// A program that is fed through its standard input, without a shell between. What it prints goes nowhere, what it
/// complains about is kept. A group of its own: Ctrl-C is for us, and we end it in order.
class ChildProcess {
public:
    /// `path` is the program's file. Throws an Error where the system cannot start it.
    ChildProcess(const std::string& path, const std::vector<std::string>& arguments);
    /// Kills it where it was not waited for.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// False: it takes no more, because it has ended or for half a minute.
    [[nodiscard]] bool feed(std::span<const unsigned char> data);
    /// Ends its input and waits until it has ended, at most `seconds`, then it is killed. Empty where it ended well;
    /// else why not: its own last words, or its exit code. Once.
    [[nodiscard]] std::string finish(double seconds);

private:
    [[nodiscard]] bool ended(double seconds) const;
    [[nodiscard]] std::string lastWords() const;

    pid_t process_ = -1;
    int input_ = -1;
    int complaints_ = -1; ///< a file in memory: it never fills up as a pipe does that nobody reads
};

/// The file of a program on PATH; empty where there is none that may be run.
std::string programOnPath(const std::string& name);

} // namespace filasofia::runtime
