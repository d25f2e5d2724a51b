#pragma once

#include "filasofia/physics/step_record.h"

#include <string_view>

namespace filasofia::record {

/// Why this step and those after it cannot be replayed; empty if they can.
inline std::string_view whyNotReplayable(const physics::StepRecord& step)
{
    if (step.report.has(physics::StepFlag::RecordLost)) return "steps before it were lost during recording";
    if (step.report.has(physics::StepFlag::Tuned)) return "tune() ran before it";
    return {};
}

} // namespace filasofia::record
