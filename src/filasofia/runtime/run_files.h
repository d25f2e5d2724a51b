#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/record/step_table.h"
#include "filasofia/runtime/parts.h"

namespace filasofia::runtime {

/// The files into which a run writes a line per step. The server's log has one reader: this.
class RunFiles {
public:
    /// Switches log and hashes on where a file was asked for, and off where none was.
    RunFiles(Simulation::Impl& parts, const RunDef& def);
    /// Writes the steps made since the last time. Throws an Error when the disk is full.
    void drain();
    /// After the last step: an Error where the disk refuses what is still on its way.
    void close();

private:
    physics::PhysicsServer& physics_;
    std::optional<record::StepTable> table_;
    std::optional<record::RecordingWriter> recording_;
};

} // namespace filasofia::runtime
