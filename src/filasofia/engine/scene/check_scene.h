#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Throws an Error naming the attachment or grasp, the field and the value unless all of them can be stepped with.
void checkAttachments(const Scene& scene);
/// The same for what the scene keeps of contacts from step to step.
void checkContacts(const Scene& scene);

} // namespace filasofia::engine
