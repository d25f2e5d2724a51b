#pragma once

#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/physics/registry.h"

namespace filasofia::physics {

struct SavedState::Content {
    std::shared_ptr<const EngineState> engine;
    Registry registry;
    AttachmentId lastAttachment;
    std::vector<Command> waiting;
    bool paused = false;
};

/// A command that waits for the next step, as a saved state has it. Error for one that makes or removes a body or
/// changes its material: it has not taken effect, and what it carries cannot be copied.
Command copyOfWaiting(const Command& command);

} // namespace filasofia::physics
