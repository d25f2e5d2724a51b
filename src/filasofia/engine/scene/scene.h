#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/body_topology.h"
#include "filasofia/engine/body/rigid_model.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/collision/side_kept.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/soft/soft_system.h"
#include "filasofia/frame/attachment.h"
#include "filasofia/frame/contact.h"

#include <cstdint>
#include <vector>

/// What the engine knows: its bodies, and what ties them together from step to step.
namespace filasofia::engine {

/// A soft body: what it is, where it is, the equations of its step, and its mesh as edits know it.
struct SoftBody {
    SoftModel model; ///< changes between steps only
    SoftState state;
    SoftSystem system;
    BodyTopology topology; ///< empty unless the body may be cut
};

struct RigidBody {
    RigidModel model; ///< changes between steps only
    RigidState state;
};

/// What outlives a step besides the bodies: time, and what happens between bodies.
struct SceneState {
    std::uint64_t step = 0;
    double time = 0.0; ///< [s]
    Vec3 gravity;      ///< [m/s^2]

    std::vector<CachedContact> contacts;  ///< the contact solve's warm start, ascending by bodies and feature
    std::vector<SideKept> sides;          ///< which side of a sheet points are on, ascending
    std::vector<frame::Contact> touching; ///< the last step's contacts, as frames carry them

    std::vector<Attachment> attachments;    ///< by rising id; pins are not among them
    std::vector<std::vector<Vec3>> holding; ///< [N] warm start per attachment and pair, the force on its body
    std::vector<PendingGrasp> grasps;       ///< by rising id
    std::vector<frame::Attachment> held;    ///< what attachments did in the last step, as frames carry it
};

/// All that the engine knows.
struct Scene : SceneState {
    std::vector<SoftBody> soft;   ///< by rising id
    std::vector<RigidBody> rigid; ///< by rising id
};

} // namespace filasofia::engine
