#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <memory>

namespace filasofia::record {

/// A CSV file with a line per step: step, time, dt, flags, iterations, hash, the number of contacts with a force, the
/// sum of their normal forces, the deepest penetration, and the durations of the stages (wall time, which is never the
/// same twice).
class StepTable {
public:
    /// Throws an Error naming the file if it cannot be written, or if this or another program is already writing it
    /// under any name. The other functions do so too, if the disk is full.
    explicit StepTable(const std::filesystem::path& file);
    ~StepTable();
    void write(const physics::StepRecord& step);
    void flush();
    /// Ends the file; nothing may be written after it. The destructor calls it too, but can only log errors.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::record
