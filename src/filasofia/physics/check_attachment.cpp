#include "filasofia/physics/check_attachment.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/check_field.h"

namespace filasofia::physics {
namespace {

/// The body that it is attached to, which must be another one.
const Registry::Body& targetOf(const Registry& registry, const Attaching& body, BodyId to, const std::string& object)
{
    if (to == body.id) fail(object, ".to must name another body, got body ", to.value, " itself");
    if (!registry.has(to)) registry.failMissing(to, object + ".to: ");
    return registry.find(to);
}

bool hasRegion(const AttachmentDef& def) { return def.box || def.ball || def.within || !def.nodes.empty(); }

/// Checks an element of the body that it is attached to: it must be 0 for a soft body.
void checkTargetElement(const Registry::Body& target, int element, const std::string& field)
{
    if (std::holds_alternative<RigidBodyDef>(*target.def))
        return checkElement(element, static_cast<std::size_t>(target.nodeCount), field);
    if (element != 0) fail(field, " must be 0 if `to` is a soft body, got ", element);
}

bool isKinematic(const BodyDef& def)
{
    const auto* rigid = std::get_if<RigidBodyDef>(&def);
    return rigid && !rigid->dynamic;
}

/// Checks pairs of nodes of two soft bodies.
void checkPairs(const AttachmentDef& def, const Registry::Body* target, const std::string& object)
{
    if (def.toNodes.empty()) return;
    if (!target || std::holds_alternative<RigidBodyDef>(*target->def))
        fail(object, ".toNodes needs a soft body `to`, whose nodes they are");
    if (def.toNodes.size() != def.nodes.size())
        fail(object, ".toNodes must have as many nodes as .nodes, which has ", def.nodes.size(), ", got ",
             def.toNodes.size());
    if (def.box || def.ball || def.within)
        fail(object, ".toNodes pairs the nodes of .nodes; box, ball and within must be empty");
    for (int node : def.toNodes)
        if (node >= target->nodeCount) fail(object, ".toNodes must be in [0, ", target->nodeCount, "), got ", node);
}

/// Points that let go one by one.
void checkParting(const Attaching& body, const AttachmentDef& def, const std::string& object)
{
    const char* field = def.pointBreakForce != kNever ? ".pointBreakForce"
                        : def.cutDistance > 0.0       ? ".cutDistance"
                                                      : "";
    if (*field == '\0') return;
    if (!def.to) fail(object, field, " needs another body that the points let go of; `to` must name one, got none");
    if (std::holds_alternative<RodBodyDef>(body.def))
        fail(object, field, " is not for rods: the points of a rod let go together (breakForce)");
}

} // namespace

void checkAttachment(const Registry& registry, const Attaching& body, const AttachmentDef& def,
                     const std::string& object)
{
    validate(def, object);
    for (int node : def.nodes)
        if (node >= body.nodeCount) fail(object, ".nodes must be in [0, ", body.nodeCount, "), got ", node);
    if (def.box && geometry::isEmpty(*def.box)) fail(object, ".box.high must be >= low on every axis");
    checkParting(body, def, object);
    if (!def.to) {
        checkPairs(def, nullptr, object);
        if (def.within)
            fail(object, ".within needs another body, to which it is a distance; `to` must name one, got none");
        if (!hasRegion(def)) fail(object, " must name nodes, a box, a ball or another body, got none");
        if (def.element != 0) fail(object, ".element must be 0 if `to` names no body, got ", def.element);
        return;
    }
    const Registry::Body& target = targetOf(registry, body, def.to, object);
    checkTargetElement(target, def.element, object + ".element");
    checkPairs(def, &target, object);
    const auto* rigid = std::get_if<RigidBodyDef>(target.def.get());
    if (rigid && !isGiven(rigid->mesh) && (def.within || !hasRegion(def)))
        fail(object, def.within ? ".within" : "", " needs a mesh of rigid body '", rigid->name,
             "' to find the nodes near it; that body has none");
}

void checkAttachment(const Registry& registry, const Attaching& body, const RigidAttachmentDef& def,
                     const std::string& object)
{
    validate(def, object);
    checkElement(def.element, static_cast<std::size_t>(body.nodeCount), object + ".element");
    for (std::size_t i = 0; i < def.points.size(); ++i)
        if (!(length(def.points[i]) < kFarthest))
            fail(object, ".points[", i, "] must lie within ", kFarthest, " m of the element's origin");
    const Registry::Body* target = def.to ? &targetOf(registry, body, def.to, object) : nullptr;
    if (target)
        checkTargetElement(*target, def.toElement, object + ".toElement");
    else if (def.toElement != 0)
        fail(object, ".toElement must be 0 if `to` names no body, got ", def.toElement);
    if (isKinematic(body.def) && (!target || isKinematic(*target->def)))
        fail(object, " must have a dynamic or soft body on one side; both are kinematic");
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
