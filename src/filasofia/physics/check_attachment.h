#pragma once

#include "filasofia/physics/registry.h"

namespace filasofia::physics {

/// A body that is, or is to be, attached to another.
struct Attaching {
    BodyId id = {}; ///< none: it is being added
    const BodyDef& def;
    int nodeCount = 0; ///< of a rigid one: elements
};

/// Throws an Error beginning with `object` unless the attachment can be made, as far as is known outside a step.
void checkAttachment(const Registry& registry, const Attaching& body, const AttachmentDef& def,
                     const std::string& object);
void checkAttachment(const Registry& registry, const Attaching& body, const RigidAttachmentDef& def,
                     const std::string& object);

/// All of a Def's.
void checkAttachments(const Registry& registry, const Attaching& body);

} // namespace filasofia::physics
