#pragma once

#include "filasofia/physics/registry.h"

namespace filasofia::physics {

/// A body whose attachment is checked.
struct Attaching {
    BodyId id = {}; ///< none if it is being added
    const BodyDef& def;
    int nodeCount = 0; ///< number of elements if the body is rigid
};

/// Throws an Error beginning with `object` unless the attachment can be made, as far as this is known outside a step.
void checkAttachment(const Registry& registry, const Attaching& body, const AttachmentDef& def,
                     const std::string& object);
void checkAttachment(const Registry& registry, const Attaching& body, const RigidAttachmentDef& def,
                     const std::string& object);

/// Checks all attachments of a Def.
void checkAttachments(const Registry& registry, const Attaching& body);

} // namespace filasofia::physics
