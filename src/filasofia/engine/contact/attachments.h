#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Attachments that are no pins: pairs of points, each of which becomes a weld in every step.
namespace filasofia::engine {

/// Which attachment it is, and the body that is held.
struct AttachmentName {
    AttachmentId id;
    BodyId body;
};

/// Makes an attachment at the present state. If nothing is in its regions, the report says so, and the log.
void attach(const AttachmentName& name, const physics::AttachmentDef& def, Scene& scene, physics::StepReport& report);
void attach(const AttachmentName& name, const physics::RigidAttachmentDef& def, Scene& scene,
            physics::StepReport& report);

/// Takes an attachment in; `forces` [N] per pair, on its body: where the solve starts.
void addAttachment(Attachment attachment, std::vector<Vec3> forces, Scene& scene);

/// Lets go. Nothing happens if there is no attachment of this id.
void release(AttachmentId id, Scene& scene);
void removeAttachmentsOf(BodyId id, Scene& scene);

/// Adds the welds of all attachments after the contacts. Grasps that wait for contacts become attachments first, and
/// contacts between what is welded already are removed.
void addWelds(const StepContext& context, Scene& scene, Coupling& coupling);

/// Keeps what attachments and pins did in the step of dt [s]; attachments that had to bear too much break.
void keepWelds(double dt, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
