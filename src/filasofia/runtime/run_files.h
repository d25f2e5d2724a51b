#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/record/step_table.h"
#include "filasofia/runtime/simulation_impl.h"

#include <condition_variable>
#include <set>
#include <thread>

namespace filasofia::runtime {

/// The files into which a run writes as it goes. A thread of their own writes them, so that neither physics nor the
/// picture waits for a disk; it is the only reader of the server's log. A problem is logged once and posted as an
/// event, and the run goes on.
class RunFiles {
public:
    /// Opens the files and begins. Switches log and hashes on if a file was asked for, else off. Error if a file cannot
    /// be opened.
    RunFiles(Simulation::Impl& impl, const RunDef& def);
    /// Writes what is still in the log and closes the files.
    ~RunFiles();
    RunFiles(const RunFiles&) = delete;
    RunFiles& operator=(const RunFiles&) = delete;

    /// Call it after every step of a run that does not wait for a clock. It waits if the files are so far behind that
    /// steps would be lost.
    void keepUp();
    /// Call it after the last step.
    void close();

private:
    void work();
    void drain();
    void write(const physics::StepRecord& step);
    void writeScene(std::uint64_t beforeStep);
    void flush();
    /// Runs `write` unless the file has failed before. If it fails now, logs and posts the problem and gives up the
    /// file.
    template <class File, class Write> void attempt(std::optional<File>& file, Write&& write);

    Simulation::Impl& impl_;
    std::optional<record::StepTable> table_;
    std::optional<record::RecordingWriter> recording_;
    std::set<std::string> filesDescribed_; ///< named by materials, and already described in the recording
    std::atomic<std::uint64_t> made_ = 0;  ///< steps counted by keepUp()
    std::atomic<std::uint64_t> written_ = 0;

    std::mutex mutex_;
    std::condition_variable wake_, caughtUp_;
    bool ending_ = false; ///< under the lock
    std::thread thread_;  ///< last, because it uses all other members; not running if there is no file
};

} // namespace filasofia::runtime
