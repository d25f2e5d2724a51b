#include "filasofia/engine/step/add_body.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/piercing/channels.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/scene/find_body.h"

#include <utility>

namespace filasofia::engine {
namespace {

/// Adds the attachments of a body that has just been added. Pins are part of the body already and only get their ids.
void addAttachments(const physics::AddBody& add, Scene& scene, physics::StepReport& report)
{
    std::uint32_t next = add.attachments.value;
    const auto takeId = [&] { return AttachmentId{next == 0 ? 0 : next++}; };
    const auto addAll = [&](const auto& attachments) {
        for (std::size_t group = 0; const auto& def : attachments) {
            const AttachmentId id = takeId();
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(def)>, physics::AttachmentDef>)
                if (isPins(def)) {
                    SoftBody& body = scene.soft.back();
                    if (SoftModel* start = body.topology.start.get()) start->pins.groups[group].id = id;
                    body.model.pins.groups[group++].id = id;
                    continue;
                }
            attach({id, add.id}, def, scene, report);
        }
    };
    std::visit([&](const auto& def) { addAll(def.attachments); }, *add.def);
}

} // namespace

void addBody(physics::AddBody& add, Scene& scene, physics::StepReport& report)
{
    if (auto* soft = dynamic_cast<BuiltSoftBody*>(add.body.get())) { // ids ascend: the lists stay sorted
        soft->body.model.id = add.id;
        scene.soft.push_back(std::move(soft->body));
    } else {
        auto& rigid = dynamic_cast<BuiltRigidBody&>(*add.body);
        rigid.body.model.id = add.id;
        scene.rigid.push_back(std::move(rigid.body));
        placeLinks(scene.rigid.size() - 1, scene);
    }
    addAttachments(add, scene, report);
    add.body.reset(); // the recording keeps the command, but not the empty body
}

void removeBody(BodyId id, Scene& scene)
{
    removeAttachmentsOf(id, scene);
    removeChannelsOf(id, scene);
    const auto touches = [&](const auto& contact) { return contact.first == id || contact.second == id; };
    std::erase_if(scene.contactReports, touches);
    std::erase_if(scene.channelReports,
                  [&](const frame::Channel& each) { return each.tissue == id || each.needle == id; });
    std::erase_if(scene.contacts, touches);
    std::erase_if(scene.sides, [&](const SheetSide& kept) { return kept.source.body == id || kept.target.body == id; });
    const auto is = [&](const auto& body) { return body.model.id == id; };
    const std::size_t erased = std::erase_if(scene.soft, is) + std::erase_if(scene.rigid, is);
    FILASOFIA_ASSERT(erased == 1);      // the server has checked that the body exists
    for (RigidBody& body : scene.rigid) // a base that it carried stays where it is
        if (body.model.articulation.to == id) body.model.articulation.to = {};
}

} // namespace filasofia::engine
