#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace filasofia::visual {

/// While it lives, nothing reaches standard output. Filament greets there, and a program's output belongs to the
/// program. The whole process is concerned: keep it short. Its errors go to standard error and stay.
class QuietOutput {
public:
    QuietOutput()
    {
        std::fflush(stdout);
        saved_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
        if (const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC); saved_ >= 0 && nowhere >= 0) {
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
    int saved_ = -1;
};

} // namespace filasofia::visual
