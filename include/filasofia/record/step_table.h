#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <memory>

namespace filasofia::record {

/// A CSV file with a line per step: step, time, dt, flags, iterations, hash, and what the stages took (wall time, which
/// is never the same twice).
class StepTable {
public:
    /// Throws an Error naming the file when it cannot be written; so do the others, when the disk is full.
    explicit StepTable(const std::filesystem::path& file);
    ~StepTable();
    void write(const physics::StepRecord& step);
    void flush();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::record
