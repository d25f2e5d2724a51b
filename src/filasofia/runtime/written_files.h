#pragma once

#include "filasofia/runtime/run.h"

#include "filasofia/core/error.h"

#include <string>
#include <vector>

namespace filasofia::visual {
struct Image;
}

namespace filasofia::runtime {

/// The files that a run has written, and what went wrong with them.
class WrittenFiles {
public:
    /// Begins a run.
    void begin();
    /// A picture or video was written. Main thread.
    void addPicture(const std::string& file) { pictures_.push_back(file); }
    /// Calls write(), and returns whether it could. If it throws an Error, that is logged and kept: the run goes on.
    /// Main thread.
    template <class Write> bool attempt(Write&& write)
    {
        try {
            write();
            return true;
        } catch (const Error& problem) {
            keep(problem);
            return false;
        }
    }
    /// Writes a picture and adds it, if it can be written. Main thread.
    void savePicture(const visual::Image& image, const std::string& file);
    /// A file that gets a line per step (log, recording) is incomplete. The files' thread; fill() comes after its end.
    void addFileProblem(const std::string& problem) { fileProblems_.push_back(problem); }
    void fill(RunReport& report) const;

private:
    void keep(const Error& problem);

    std::vector<std::string> pictures_;
    std::vector<std::string> pictureProblems_;
    std::vector<std::string> fileProblems_; ///< apart from the above: another thread writes it
};

} // namespace filasofia::runtime
