#include "filasofia/record/step_log.h"

#include "filasofia/physics/physics_server.h"
#include "filasofia/record/replayable.h"

#include <algorithm>

namespace filasofia::record {

void StepLog::drain(physics::PhysicsServer& server)
{
    while (physics::StepRecord* record = server.nextRecord()) {
        steps_.push_back(std::move(*record));
        server.popRecord();
    }
}

bool StepLog::replayable() const
{
    return std::all_of(steps_.begin(), steps_.end(), [](const auto& step) { return whyNotReplayable(step).empty(); });
}

} // namespace filasofia::record
