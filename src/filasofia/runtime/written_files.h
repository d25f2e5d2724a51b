#pragma once

#include "filasofia/runtime/run.h"

#include <string>
#include <vector>

namespace filasofia::runtime {

/// The files that a run has written, and what went wrong with them.
class WrittenFiles {
public:
    /// Begins a run.
    void begin();
    /// A picture or video was written. Main thread.
    void addPicture(const std::string& file) { pictures_.push_back(file); }
    /// A screenshot could not be written. Main thread.
    void addPictureProblem(const std::string& problem) { pictureProblems_.push_back(problem); }
    /// A file that gets a line per step (log, recording) is incomplete. The files' thread; fill() comes after its end.
    void addFileProblem(const std::string& problem) { fileProblems_.push_back(problem); }
    [[nodiscard]] const std::vector<std::string>& pictures() const { return pictures_; }
    void fill(RunReport& report) const;

private:
    std::vector<std::string> pictures_;
    std::vector<std::string> pictureProblems_;
    std::vector<std::string> fileProblems_; ///< apart from the above: another thread writes it
};

} // namespace filasofia::runtime
