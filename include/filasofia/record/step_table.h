#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <memory>

namespace filasofia::record {

/// A CSV file with a line per step: step, time, dt, flags, iterations, hash, contacts that push with the
/// sum of their normal forces and the deepest penetration, and what the stages took (wall time, which is never the same
/// twice).
class StepTable {
public:
    /// Throws an Error naming the file when it cannot be written, or is being written already by this program or
    /// another, under whatever name; so do the others, when the disk is full.
    explicit StepTable(const std::filesystem::path& file);
    ~StepTable();
    void write(const physics::StepRecord& step);
    void flush();
    /// The end; nothing may be written after it. The destructor does it too, and can only log what goes wrong.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::record
