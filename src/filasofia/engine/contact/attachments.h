#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Attachments other than pins: pairs of points, each of which becomes a weld constraint in every step.
namespace filasofia::engine {

/// An attachment's id, and the body that it is defined on.
struct AttachmentName {
    AttachmentId id;
    BodyId body;
};

/// A body as messages name it: "soft body 'liver'".
std::string nameOf(const Scene& scene, BodyId id);

/// Makes an attachment in the current state. If nothing is in its regions, the report says so and a warning is
/// logged.
void attach(const AttachmentName& name, const physics::AttachmentDef& def, Scene& scene, physics::StepReport& report);
void attach(const AttachmentName& name, const physics::RigidAttachmentDef& def, Scene& scene,
            physics::StepReport& report);

/// Adds an attachment. `forces` [N] per pair, on its body, start the next solve. The edges of a rod whose two nodes it
/// holds on a rigid body turn with that body.
void addAttachment(Attachment attachment, std::vector<Vec3> forces, Scene& scene);

/// Removes the pairs for which `gone` is true, and their warm start. Returns their number.
int erasePairs(std::size_t attachment, const std::vector<bool>& gone, Scene& scene);

/// Finds the edges of rods that are clamped by attachments. The system of a rod where that has changed is outdated.
void findHeldEdges(Scene& scene);

/// Removes an attachment or a pending grasp. Does nothing if there is none with this id.
void release(AttachmentId id, Scene& scene);
void removeAttachmentsOf(BodyId id, Scene& scene);

/// Adds the welds of all attachments after the contacts. Pending grasps become attachments first, and contacts between
/// points that are welded are removed.
void addWelds(const StepContext& context, Scene& scene, Coupling& coupling);

/// Where the points of attachments are that can let go one by one.
void placePoints(const Scene& scene, std::vector<frame::AttachedPoint>& out);

/// Stores the reactions of attachments and pins in the step. Attachments break if their force exceeded the
/// limit.
void keepWelds(const StepContext& context, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
