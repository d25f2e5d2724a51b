#pragma once

#include "filasofia/frame/attachment.h"
#include "filasofia/frame/boundary.h"
#include "filasofia/frame/cavity.h"
#include "filasofia/frame/channel.h"
#include "filasofia/frame/clip.h"
#include "filasofia/frame/contact.h"
#include "filasofia/frame/joint.h"
#include "filasofia/math/pose.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace filasofia::frame {

/// The state of one soft body, a shell and a rod included.
struct SoftBodyFrame {
    BodyId id = {};
    std::vector<Vec3> positions = {};  ///< [m], one per node
    std::vector<Vec3> velocities = {}; ///< [m/s], one per node
    std::shared_ptr<const Boundary> boundary =
        {}; ///< the boundary of a body with dynamicTopology; empty if its mesh was never edited
    /// Rods only, per edge: a unit vector across it, which turns with the material
    std::vector<Vec3> directors = {};
    std::vector<int> cutEdges = {}; ///< rods only: edges that are gone since they were cut or torn, ascending
};

/// The state of one rigid body, per element.
struct RigidBodyFrame {
    BodyId id = {};
    std::vector<Pose> poses = {}; ///< from the element's coordinates to the world
    /// [m/s], velocity of the centre of mass of a dynamic element; velocity of the origin for a link and for a
    /// kinematic element (0 in a step in which it jumped)
    std::vector<Vec3> velocities = {};
    std::vector<Vec3> angularVelocities = {}; ///< [rad/s], in world axes
    std::vector<Joint> joints = {};           ///< the joints of an articulated body, in the order of its Def
};

/// The whole state after one step, as everyone outside the engine sees it. Immutable once published.
struct Frame {
    std::uint64_t step = 0;                       ///< number of steps completed
    double time = 0.0;                            ///< [s], simulated
    std::vector<SoftBodyFrame> softBodies = {};   ///< in the order of their ids
    std::vector<RigidBodyFrame> rigidBodies = {}; ///< in the order of their ids
    std::vector<Contact> contacts = {};           ///< the contacts of the step with their forces
    std::vector<Attachment> attachments = {};     ///< in the order of their ids
    /// Those that hold, of attachments with pointBreakForce or cutDistance, in the order of these
    std::vector<AttachedPoint> attachedPoints = {};
    std::vector<Channel> channels = {}; ///< needles in tissue, in the order in which they began
    std::vector<Cavity> cavities = {};  ///< in all soft bodies, in the order of their ids
    std::vector<Clip> clips = {};       ///< on all soft bodies, in the order of their ids

    [[nodiscard]] const SoftBodyFrame* softBody(BodyId id) const;   ///< nullptr if there is none
    [[nodiscard]] const RigidBodyFrame* rigidBody(BodyId id) const; ///< nullptr if there is none
};

} // namespace filasofia::frame
