#pragma once

#include "filasofia/physics/physics_server.h"

#include <variant>

namespace filasofia::physics {

/// The commands that can be copied, as data of a program. In one that makes an attachment, its `id` means nothing: the
/// server gives it.
using GivenCommand = std::variant<RemoveBody, SetPose, SetWrench, SetJoint, SetHaptic, SetGravity, SetTissue,
                                  SetFibreStress, SetCurvature, SetCutting, SetCavity, SetForces, SetPressure, Attach,
                                  AttachRigid, Grasp, ApplyClip, Release, RemovePiece, Pause>;

/// Gives a command to a server, by the function of its name. Returns the id of the attachment that it makes, or none.
/// Throws an Error as that function does.
AttachmentId give(PhysicsServer& server, const GivenCommand& command);

} // namespace filasofia::physics
