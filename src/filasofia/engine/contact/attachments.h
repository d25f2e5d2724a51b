#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/soft/soft_system.h"
#include "filasofia/physics/step.h"

/// Attachments that are no pins: pairs of points, each of which becomes a link in every step.
namespace filasofia::engine {

/// Makes one at the present state. Where nothing is in its regions the report says so, and the log.
void attach(AttachmentId id, BodyId body, const physics::AttachmentDef& def, const Model& model, State& state,
            physics::StepReport& report);
void attach(AttachmentId id, BodyId body, const physics::RigidAttachmentDef& def, const Model& model, State& state,
            physics::StepReport& report);

/// Takes one in; `forces` [N] per pair, on its body: where the solve starts.
void addAttachment(Attachment attachment, std::vector<Vec3> forces, State& state);

/// Lets go. Nothing happens where there is none of this id.
void release(AttachmentId id, State& state);
void removeAttachmentsOf(BodyId id, State& state);

/// Turns the contacts of this step into the attachments that wait for them.
void graspContacts(const Model& model, State& state, const Coupling& coupling, physics::StepReport& report);

/// What a hard attachment holds cannot be pushed apart as well: such contacts go, and others of two bodies that hold
/// each other hard stay as deep as they are. Two laws that want different things of one point would work against each
/// other with forces that grow without end.
void leaveToAttachments(const State& state, Coupling& coupling);

/// Adds what every group of pins did in the step.
void addPinReports(const Model& model, double dt, const Coupling& coupling, const State& state,
                   const std::vector<SoftSystem>& systems, std::vector<frame::Attachment>& out);

} // namespace filasofia::engine
