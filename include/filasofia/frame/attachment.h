#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::frame {

/// The state of an attachment after a step. An attachment that broke at the end of the step is listed for the last
/// time.
struct Attachment {
    AttachmentId id = {};
    BodyId body = {};
    BodyId to = {};  ///< the other body; no body means space
    Vec3 force = {}; ///< [N] on `body`, summed over the attached points; `to` gets the opposite
    /// [N m] on `body`, a rod that turns with `to`: the moment about its edges, without those of the forces
    Vec3 torque = {};
    int points = 0;      ///< number of attached points
    bool broken = false; ///< its force exceeded what it bears, or its last point let go
    int parted = 0; ///< number of points that let go at the end of this step, or that a blade parted in the last one
};

/// A point of an attachment whose points can let go one by one.
struct AttachedPoint {
    AttachmentId attachment = {};
    int node = 0;      ///< the node of the attached body; the first, if it lies between several
    Vec3 place = {};   ///< [m] where it is on the attached body
    Vec3 toPlace = {}; ///< [m] and on the other
};

/// Whether attachments hold two bodies together, directly or through other bodies.
bool connected(BodyId one, BodyId other, const std::vector<Attachment>& attachments);

/// [N] The total force on `body` of all attachments to other bodies; attachments to space do not count.
Vec3 forceOn(BodyId body, const std::vector<Attachment>& attachments);

} // namespace filasofia::frame
