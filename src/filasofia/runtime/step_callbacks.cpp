#include "filasofia/runtime/step_callbacks.h"

#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"

namespace filasofia::runtime {

void StepCallbacks::call(double end)
{
    for (auto& callback : callbacks_) {
        if (!callback) continue;
        // As with observers: one mistake does not end physics.
        if (const auto problem = guardedCall([&] { callback(end); })) {
            logError("simulation: everyStep: ", *problem, "; it is not called again");
            problems_.push_back(*problem);
            callback = nullptr;
        }
    }
}

} // namespace filasofia::runtime
