#include "filasofia/runtime/step_callbacks.h"

#include "filasofia/core/log.h"

#include <exception>

namespace filasofia::runtime {

void StepCallbacks::call(double end)
{
    for (auto& callback : callbacks_) {
        if (!callback) continue;
        try {
            callback(end);
        } catch (const std::exception& problem) { // as with observers: one mistake does not end physics
            logError("simulation: everyStep: ", problem.what(), "; it is not called again");
            callback = nullptr;
        }
    }
}

} // namespace filasofia::runtime
