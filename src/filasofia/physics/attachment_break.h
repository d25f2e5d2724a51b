#pragma once

#include "filasofia/frame/attachment.h"
#include "filasofia/physics/step.h"

#include <optional>

namespace filasofia::physics {

/// What of an attachment let go in a step; nothing if all holds. `left`: its points after the step, before all of it
/// goes because it is broken.
inline std::optional<AttachmentBreak> breakOf(const frame::Attachment& now, int left, bool grasp)
{
    if (!now.broken && now.parted == 0) return std::nullopt;
    return AttachmentBreak{.id = now.id,
                           .body = now.body,
                           .to = now.to,
                           .grasp = grasp,
                           .force = length(now.force),
                           .points = now.parted + (now.broken ? left : 0),
                           .broken = now.broken};
}

} // namespace filasofia::physics
