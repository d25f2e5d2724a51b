#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// A program that is fed through its standard input, started without a shell. Its standard output is discarded, its
/// standard error is kept. It has a process group of its own, so that Ctrl-C reaches only us and we end it in order.
class ChildProcess {
public:
    /// `path` is the program's file. Throws an Error if the system cannot start it.
    ChildProcess(const std::string& path, const std::vector<std::string>& arguments);
    /// Kills the program if finish() was not called.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Returns false if the program has ended or takes no data for half a minute.
    [[nodiscard]] bool feed(std::span<const unsigned char> data);
    /// Closes the program's input and waits at most `seconds` for its end, then kills it. Returns an empty string if it
    /// ended well, else the reason: its last line of standard error, or its exit code. Call it once.
    [[nodiscard]] std::string finish(double seconds);

private:
    [[nodiscard]] bool ended(double seconds) const;
    [[nodiscard]] std::string lastErrorLine() const;

    pid_t process_ = -1;
    int input_ = -1;
    int errorOutput_ = -1; ///< standard error, as a file in memory, which cannot fill up like a pipe that nobody reads
};

/// The file of a program on PATH; empty if there is none that may be run.
std::string programOnPath(const std::string& name);

} // namespace filasofia::runtime
