#pragma once

#include "filasofia/engine/body/model.h"

#include <functional>

namespace filasofia::physics {
class PhysicsServer;
}

/// The door to the native engine's own data, for fine-tuning. No promise of stability: this header's types follow the
/// engine wherever it goes.
namespace filasofia::engine {

/// The engine's data, valid for the length of one tune() call.
struct Native {
    Model& model;
    State& state;
};

/// Runs `change` once, at the start of the next step, with mutable access to model and state. Afterwards everything is
/// checked as if it had just been built: where `change` throws or leaves something invalid, all is put back, the log
/// says why, and the step's report has StepFlag::TuneRejected. The recording is marked as not replayable from there.
/// Error where the server's engine is another one.
void tune(physics::PhysicsServer& server, std::function<void(Native&)> change);

} // namespace filasofia::engine
