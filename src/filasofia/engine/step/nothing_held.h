#pragma once

#include "filasofia/engine/contact/attachments.h"

/// Attachments and grasps, and the report of those that hold nothing.
namespace filasofia::engine {

/// Makes an attachment as attach() does. If it holds nothing, the report says which.
template <class Def>
void attachOrTell(const AttachmentName& name, const Def& def, Scene& scene, physics::StepReport& report);

/// Adds welds as addWelds() does. The report says which of the grasps that waited hold nothing.
void addWeldsAndTell(const StepContext& context, Scene& scene, Coupling& coupling);

/// Whether there is an attachment of this id.
bool hasAttachment(const Scene& scene, AttachmentId id);

} // namespace filasofia::engine
