#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::frame {

/// What an attachment did during a step. One that broke at its end is there for the last time.
struct Attachment {
    AttachmentId id = {};
    BodyId body = {};
    BodyId to = {};      ///< none: space
    Vec3 force = {};     ///< [N] on `body`, the sum over its points; on `to` the opposite
    int points = 0;      ///< that it holds
    bool broken = false; ///< the force was more than it stands
};

/// [N] By which all that holds `body`, or that it holds, pulls at it; what ties it to space does not count.
Vec3 forceOn(BodyId body, const std::vector<Attachment>& attachments);

} // namespace filasofia::frame
