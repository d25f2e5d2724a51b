#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <array>
#include <vector>

namespace filasofia::engine {

struct NodeWeight {
    int node = 0;
    double weight = 0.0;
};

/// A point of a body, or of space, that is held or holds.
struct AttachedPoint {
    std::vector<NodeWeight> nodes; ///< of a soft body: it is their mean; at most twelve, each once
    int element = 0;               ///< of a rigid body
    Vec3 place;                    ///< [m] of a rigid body: in the element's coordinates; of space: in the world
};

/// Pairs of points that are to be in one place. Made anew after a topology edit: the nodes are named here alone.
struct Attachment {
    AttachmentId id;
    BodyId body;                                     ///< that is held
    BodyId to;                                       ///< that holds; none: space
    std::vector<std::array<AttachedPoint, 2>> pairs; ///< of `body`, and of `to`
    double stiffness = 0.0;                          ///< [N/m] of each pair's spring; infinite: hard
    double breakForce = 0.0;                         ///< [N] of the sum of its pairs' forces; may be infinite
};

/// A grasp that waits for the contacts of the next step.
struct PendingGrasp {
    AttachmentId id;
    BodyId rigid, target;
    double stiffness = 0.0;  ///< [N/m]
    double breakForce = 0.0; ///< [N]
};

} // namespace filasofia::engine
