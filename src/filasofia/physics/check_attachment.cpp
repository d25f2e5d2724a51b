#include "filasofia/physics/check_attachment.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/check_field.h"

namespace filasofia::physics {
namespace {

/// The body that holds, which must be another one.
const Registry::Body& holderOf(const Registry& registry, const Attaching& body, BodyId to, const std::string& object)
{
    if (to == body.id) fail(object, ".to must be another body, got body ", to.value, " itself");
    if (!registry.has(to)) fail(object, ".to: body ", to.value, ": no such body (it was removed, or never added)");
    return registry.find(to);
}

bool hasRegion(const AttachmentDef& def) { return def.box || def.ball || def.within || !def.nodes.empty(); }

/// An element of the holder: of a soft one it must be 0.
void checkHolderElement(const Registry::Body& holder, int element, const std::string& field)
{
    if (std::holds_alternative<RigidBodyDef>(*holder.def))
        return checkElement(element, static_cast<std::size_t>(holder.nodeCount), field);
    if (element != 0) fail(field, " must be 0: the body that holds is soft; got ", element);
}

bool goesWhereItIsTold(const BodyDef& def)
{
    const auto* rigid = std::get_if<RigidBodyDef>(&def);
    return rigid && !rigid->dynamic;
}

} // namespace

void checkAttachment(const Registry& registry, const Attaching& body, const AttachmentDef& def,
                     const std::string& object)
{
    validate(def, object);
    for (int node : def.nodes)
        if (node >= body.nodeCount) fail(object, ".nodes must be in [0, ", body.nodeCount, "), got ", node);
    if (def.box && geometry::isEmpty(*def.box)) fail(object, ".box: high must be >= low in every axis");
    if (!def.to) {
        if (def.within) fail(object, ".within is a distance to another body: `to` must name one");
        if (!hasRegion(def)) fail(object, ": must name nodes, a box, a ball or another body, got none");
        if (def.element != 0) fail(object, ".element must be 0: no body holds it; got ", def.element);
        return;
    }
    const Registry::Body& holder = holderOf(registry, body, def.to, object);
    checkHolderElement(holder, def.element, object + ".element");
    const auto* rigid = std::get_if<RigidBodyDef>(holder.def.get());
    if (rigid && !isGiven(rigid->mesh) && (def.within || !hasRegion(def)))
        fail(object, def.within ? ".within" : "", ": nodes near rigid body '", rigid->name,
             "' can be found only where that has a mesh");
}

void checkAttachment(const Registry& registry, const Attaching& body, const RigidAttachmentDef& def,
                     const std::string& object)
{
    validate(def, object);
    checkElement(def.element, static_cast<std::size_t>(body.nodeCount), object + ".element");
    for (std::size_t i = 0; i < def.points.size(); ++i)
        if (!(length(def.points[i]) < kFarthest))
            fail(object, ".points[", i, "] must lie within ", kFarthest, " m of the element's origin");
    const Registry::Body* holder = def.to ? &holderOf(registry, body, def.to, object) : nullptr;
    if (holder)
        checkHolderElement(*holder, def.toElement, object + ".toElement");
    else if (def.toElement != 0)
        fail(object, ".toElement must be 0: no body holds it; got ", def.toElement);
    if (goesWhereItIsTold(body.def) && (!holder || goesWhereItIsTold(*holder->def)))
        fail(object, ": what goes where it is told cannot be held: one of the two must be dynamic, or soft");
}

void checkAttachments(const Registry& registry, const Attaching& body)
{
    const auto check = [&](const auto& attachments) {
        for (std::size_t i = 0; i < attachments.size(); ++i)
            checkAttachment(registry, body, attachments[i], text(describeBody(body.def), ": attachments[", i, "]"));
    };
    std::visit([&](const auto& def) { check(def.attachments); }, body.def);
}

} // namespace filasofia::physics
