#pragma once

#include "filasofia/frame/attachment.h"
#include "filasofia/frame/contact.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/step.h"

namespace filasofia::physics {

/// What the log keeps of every step: enough to make it again, and to know that it came out the same.
struct StepRecord {
    StepReport report = {};
    std::uint64_t hash = 0;                    ///< of the state after the step; 0 unless it was asked for
    std::vector<Command> commands = {};        ///< applied at its start; the built bodies are gone, their Defs remain
    std::vector<Pose> rigidPoses = {};         ///< of all rigid elements, in the order of bodies and elements
    std::vector<frame::Contact> contacts = {}; ///< where bodies were near each other, and what they did to each other
    std::vector<frame::Attachment> attachments = {}; ///< what held what, in the order of ids
};

} // namespace filasofia::physics
