#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>

namespace filasofia::visual {

/// While it lives, nothing reaches standard output. Filament prints a greeting there, but a program's output belongs to
/// the program. It concerns the whole process, so keep it short. Standard error is not touched.
class QuietOutput {
public:
    QuietOutput()
    {
        std::fflush(stdout);
        saved_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
        if (saved_ < 0) return; // there is no standard output
        if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
            dup2(nowhere, STDOUT_FILENO);
            close(nowhere);
        }
    }
    ~QuietOutput()
    {
        if (saved_ < 0) return;
        std::fflush(stdout);
        dup2(saved_, STDOUT_FILENO);
        close(saved_);
    }
    QuietOutput(const QuietOutput&) = delete;
    QuietOutput& operator=(const QuietOutput&) = delete;

private:
    static inline std::mutex one_; ///< two at once would each restore the other's /dev/null
    const std::lock_guard<std::mutex> lock_{one_};
    int saved_ = -1;
};

} // namespace filasofia::visual
