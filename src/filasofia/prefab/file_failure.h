#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/runtime/file_failed_event.h"
#include "filasofia/runtime/simulation.h"

#include <string>
#include <utility>

namespace filasofia::prefab {

/// Tells, in the log and by a FileFailedEvent, that a file took no more.
inline void tellFileFailure(runtime::Simulation& simulation, std::string problem)
{
    logError(problem);
    runtime::FileFailedEvent failure;
    failure.problem = std::move(problem);
    try {
        simulation.post(std::move(failure));
    } catch (const Error&) { // the queue is full: the log has it
    }
}

} // namespace filasofia::prefab
