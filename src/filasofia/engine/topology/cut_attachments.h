#pragma once

#include "filasofia/engine/topology/ruptures.h"

namespace filasofia::engine {

/// Parts the points of attachments that a blade's path of the step came near to (AttachmentDef::cutDistance).
void cutAttachments(std::span<const Blade> blades, Scene& scene);

} // namespace filasofia::engine
