#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"
#include "filasofia/physics/mouth.h"

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace filasofia::engine {

/// A node of a soft body and its weight in a mean.
struct NodeWeight {
    int node = 0;
    double weight = 0.0; ///< [-]
};

/// The weighted mean of the nodes' values: where the point is, or how it moves.
inline Vec3 meanOf(const std::vector<NodeWeight>& point, const std::vector<Vec3>& values)
{
    Vec3 sum;
    for (const NodeWeight& each : point) sum += each.weight * values[static_cast<std::size_t>(each.node)];
    return sum;
}

/// One end of an attachment: a point of a soft body, of an element of a rigid body, or of space.
struct AttachedPoint {
    /// Soft body only: the point is their weighted mean; at most twelve nodes, each once.
    std::vector<NodeWeight> nodes;
    int element = 0; ///< rigid body only
    Vec3 place;      ///< [m] rigid body: in the element's coordinates; space: in world coordinates
};

/// An edge of a rod that turns about itself as a rigid body does to which both its nodes are attached.
struct AttachedTurn {
    int edge = 0;
    int element = 0; ///< an element of the rigid body
    Vec3 director;   ///< that of the edge, in the element's coordinates
};

using AttachedPairs = std::vector<std::array<AttachedPoint, 2>>; ///< a point of `body` and a point of `to`

/// Pairs of points that are to coincide. A topology edit updates the points: their nodes are stored nowhere else.
struct Attachment {
    AttachmentId id;
    BodyId body; ///< the attached body
    BodyId to;   ///< the body that it is attached to; none: space
    AttachedPairs pairs;
    std::vector<AttachedTurn> turns; ///< `body` is a rod and `to` is rigid
    double stiffness = 0.0;          ///< [N/m] stiffness of each pair's spring; infinite: hard
    /// [N] the attachment breaks if the sum of its pairs' forces exceeds this; may be infinite.
    double breakForce = 0.0;
    /// [N] a pair lets go if its force exceeds this; may be infinite
    double pointBreakForce = std::numeric_limits<double>::infinity();
    double cutDistance = 0.0;                        ///< [m] how near to a pair a blade parts it; 0: it does not
    std::shared_ptr<const AttachedPairs> whole = {}; ///< if pairs can let go one by one: those that a reset brings back
    int parted = 0;                                  ///< number of pairs that blades have parted since the last report
    bool grasp = false;                              ///< made by a Grasp
};

/// A grasp that is waiting for the contacts of the next step.
struct PendingGrasp {
    AttachmentId id;
    BodyId rigid, target;
    double stiffness = 0.0;  ///< [N/m]
    double breakForce = 0.0; ///< [N]
    std::optional<physics::Mouth> mouth = {};
};

} // namespace filasofia::engine
