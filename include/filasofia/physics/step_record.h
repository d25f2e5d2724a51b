#pragma once

#include "filasofia/frame/attachment.h"
#include "filasofia/frame/channel.h"
#include "filasofia/frame/contact.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/step.h"

namespace filasofia::physics {

/// What the log keeps of every step: enough to replay it, and to verify that the result is the same.
struct StepRecord {
    StepReport report = {};
    std::uint64_t hash = 0;                    ///< hash of the state after the step; 0 unless hashes were turned on
    std::vector<Command> commands = {};        ///< applied at its start; without the built bodies, but with their Defs
    std::vector<Pose> rigidPoses = {};         ///< poses of all rigid elements, in the order of bodies and elements
    std::vector<frame::Contact> contacts = {}; ///< contacts with their forces
    std::vector<frame::Attachment> attachments = {}; ///< attachments with their forces, in the order of ids
    std::vector<frame::Channel> channels = {};       ///< channels of needles, in the order in which they began
};

} // namespace filasofia::physics
