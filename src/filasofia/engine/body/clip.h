#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/physics/clip_def.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// Two points of a tissue's surface that face each other across a clip, at the upper leg and at the lower one.
using ClipPair = std::array<std::vector<NodeWeight>, 2>;

/// A clip on a soft body. Its legs draw the points of each pair towards each other, by springs of one length, `gap`:
/// what the legs leave free. They yield as a whole: if the springs sum up to more than the legs bear, the gap grows
/// until they do not. The points keep their places in the tissue when it is cut: a clip holds on to both sides of a
/// cut.
struct Clip {
    AttachmentId id; ///< by which the rigid body is attached to the tissue; without it, the clip is gone
    BodyId clip;     ///< the rigid body
    physics::ClipDef def;
    std::vector<ClipPair> pairs;
    std::vector<std::size_t> corners = {}; ///< the pairs whose middles the rigid body hangs on
    double gap = 0.0;                      ///< [m]
    double age = 0.0;                      ///< [s] since it began to close
    double force = 0.0;                    ///< [N] that all pairs pull with
    bool partial = false;                  ///< tissue went on beyond its legs when it was applied

    [[nodiscard]] double pairStiffness() const { return def.stiffness / static_cast<double>(pairs.size()); } ///< [N/m]
};

} // namespace filasofia::engine
