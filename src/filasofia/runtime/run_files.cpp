#include "filasofia/runtime/run_files.h"

#include "filasofia/engine/solver_costs.h"

namespace filasofia::runtime {

RunFiles::RunFiles(Simulation::Impl& parts, const RunDef& def) : physics_(parts.physics)
{
    if (!def.log.empty()) table_.emplace(def.log);
    if (!def.record.empty())
        recording_.emplace(def.record, record::RecordingHeader{.simd = engine::simdTargets().front(),
                                                               .period = 1.0 / parts.def.physics.rate,
                                                               .contact = parts.def.physics.contact});
    while (physics_.nextRecord()) physics_.popRecord(); // left by a run that failed
    physics_.keepLog(table_ || recording_);
    physics_.hashEveryStep(table_ || recording_);
}

void RunFiles::drain()
{
    bool wrote = false;
    for (; const physics::StepRecord* step = physics_.nextRecord(); wrote = true) {
        if (table_) table_->write(*step);
        if (recording_) recording_->write(*step);
        physics_.popRecord();
    }
    if (!wrote) return;
    if (table_) table_->flush();
    if (recording_) recording_->flush();
}

void RunFiles::close()
{
    drain();
    if (table_) table_->close();
    if (recording_) recording_->close();
}

} // namespace filasofia::runtime
