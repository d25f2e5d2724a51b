#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/body_topology.h"
#include "filasofia/engine/body/channel.h"
#include "filasofia/engine/body/rigid_model.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/collision/sheet_side.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/constraint/tied_coarse.h"
#include "filasofia/engine/soft/soft_system.h"
#include "filasofia/frame/attachment.h"
#include "filasofia/frame/cavity.h"
#include "filasofia/frame/channel.h"
#include "filasofia/frame/clip.h"
#include "filasofia/frame/contact.h"

#include <cstdint>
#include <memory>
#include <vector>

/// The engine's state: its bodies, and what persists between them from step to step.
namespace filasofia::engine {

/// A soft body: its properties, its state, the equations of its step, and its editable mesh.
struct SoftBody {
    SoftModel model; ///< changes between steps only
    SoftState state;
    SoftSystem system;
    BodyTopology topology; ///< empty unless the body may be cut
};

/// A rigid body: its properties and its state. With joints it is an articulation, and its elements are the links.
struct RigidBody {
    RigidModel model; ///< changes between steps only
    RigidState state;
};

/// Soft bodies that attachments hold together, and what their coarse levels know of these attachments.
struct TiedBodies {
    std::vector<BodyId> bodies; ///< ascending
    std::shared_ptr<const TiedCoarse> coarse;
};

/// All of these, and what they were made for: they serve while that stays nearly the same.
struct Ties {
    struct Made {
        AttachmentId attachment;
        std::size_t pairs = 0;
        Mat3 turn;         ///< the rotation of `body` at the attachment, transposed, times that of `to`
        bool tied = false; ///< it belongs to a group
    };
    std::vector<Made> made; ///< ascending
    std::vector<TiedBodies> groups;
};

/// What persists from step to step besides the bodies: time, gravity, and contacts and attachments between bodies.
struct SceneState {
    std::uint64_t step = 0;
    double time = 0.0; ///< [s]
    Vec3 gravity;      ///< [m/s^2]

    std::vector<CachedContact> contacts;        ///< warm start of the contact solve, ascending by bodies and feature
    std::vector<SheetSide> sides;               ///< the side of a sheet that points are on, ascending
    std::vector<frame::Contact> contactReports; ///< the last step's contacts, as frames carry them

    std::vector<Attachment> attachments; ///< ascending by id, without pins
    /// [N] warm start per attachment: for each pair the force on its body, then for each turn the moment along x, over
    /// the rod's radius
    std::vector<std::vector<Vec3>> attachmentForces;
    std::vector<PendingGrasp> grasps; ///< ascending by id
    std::vector<frame::Attachment>
        attachmentReports; ///< forces of the attachments in the last step, as frames carry them

    std::vector<Channel> channels;              ///< needles in tissue, in the order in which they began
    std::vector<frame::Channel> channelReports; ///< the channels of the last step, as frames carry them
    std::vector<frame::Cavity> cavityReports;   ///< the same of cavities
    std::vector<frame::Clip> clipReports;       ///< the same of clips
};

/// The whole state of the engine.
struct Scene : SceneState {
    std::vector<SoftBody> soft;   ///< ascending by id
    std::vector<RigidBody> rigid; ///< ascending by id
    Ties ties;
};

} // namespace filasofia::engine
