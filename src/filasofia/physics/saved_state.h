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

/// A command that waits for the next step, as a saved state has it. Error for AddBody, RemoveBody, SetMaterial and
/// Tune: they must take effect before the state can be saved.
Command copyOfWaiting(const Command& command);

} // namespace filasofia::physics
