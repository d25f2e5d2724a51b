#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/record/step_table.h"
#include "filasofia/runtime/simulation_impl.h"

#include <condition_variable>
#include <set>
#include <thread>

namespace filasofia::runtime {

/// The files into which a run writes as it goes. They have a thread of their own, so that neither physics nor the
/// picture waits for a disk; it is the one reader of the server's log. What goes wrong is logged once and told by an
/// event, and the run goes on.
class RunFiles {
public:
    /// Opens the files and begins. Switches log and hashes on where a file was asked for, and off where none was. An
    /// Error where a file cannot be opened.
    RunFiles(Simulation::Impl& impl, const RunDef& def);
    /// Writes what there is, and ends.
    ~RunFiles();
    RunFiles(const RunFiles&) = delete;
    RunFiles& operator=(const RunFiles&) = delete;

    /// After every step of a run that no clock holds back: waits where the files are so far behind that steps would be
    /// lost.
    void keepUp();
    /// After the last step.
    void close();

private:
    void work();
    void drain();
    void write(const physics::StepRecord& step);
    void writeScene(std::uint64_t beforeStep);
    void flush();
    /// Runs `write`, unless the file has failed before; where it fails now, tells and forgets the file.
    template <class File, class Write> void attempt(std::optional<File>& file, Write&& write);

    Simulation::Impl& impl_;
    std::optional<record::StepTable> table_;
    std::optional<record::RecordingWriter> recording_;
    std::set<std::string> filesTold_;     ///< that materials name
    std::atomic<std::uint64_t> made_ = 0; ///< steps that keepUp() was told of
    std::atomic<std::uint64_t> written_ = 0;

    std::mutex mutex_;
    std::condition_variable wake_, caughtUp_;
    bool ending_ = false; ///< under the lock
    std::thread thread_;  ///< the last: it uses all of the others; none where there is no file
};

} // namespace filasofia::runtime
