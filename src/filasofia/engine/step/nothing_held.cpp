#include "filasofia/engine/step/nothing_held.h"

#include <algorithm>

namespace filasofia::engine {

bool hasAttachment(const Scene& scene, AttachmentId id)
{
    return std::ranges::binary_search(scene.attachments, id, {}, &Attachment::id);
}

template <class Def>
void attachOrTell(const AttachmentName& name, const Def& def, Scene& scene, physics::StepReport& report)
{
    attach(name, def, scene, report);
    if (!hasAttachment(scene, name.id)) report.nothingHeld.push_back({.id = name.id, .body = name.body, .to = def.to});
}
template void attachOrTell(const AttachmentName&, const physics::AttachmentDef&, Scene&, physics::StepReport&);
template void attachOrTell(const AttachmentName&, const physics::RigidAttachmentDef&, Scene&, physics::StepReport&);

void addWeldsAndTell(const StepContext& context, Scene& scene, Coupling& coupling)
{
    const std::vector<PendingGrasp> wanted = scene.grasps; // empty in nearly every step: nothing is allocated
    addWelds(context, scene, coupling);
    if (!scene.grasps.empty()) return; // time stands still
    for (const PendingGrasp& each : wanted)
        if (!hasAttachment(scene, each.id))
            context.report.nothingHeld.push_back({.id = each.id, .body = each.rigid, .to = each.target, .grasp = true});
}

} // namespace filasofia::engine
