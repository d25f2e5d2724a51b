#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Throws an Error that names the attachment or grasp, the field and the value if one of them is invalid.
void checkAttachments(const Scene& scene);
/// The same for the contact data that the scene keeps from step to step.
void checkContacts(const Scene& scene);

} // namespace filasofia::engine
