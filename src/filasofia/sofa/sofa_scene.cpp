#include "filasofia/sofa/sofa_scene.h"

namespace filasofia::sofaengine {

void startConstraints(SofaScene& scene)
{
    if (scene.contact.isOn()) return;
    scene.contact.start(*scene.root);
    if (!scene.contact.isExact()) return;
    for (const auto& body : scene.soft) body->joinConstraints();
    for (const auto& body : scene.rigid) body->joinConstraints();
}

void startContact(const std::vector<CollisionPlan>& collision, SofaScene& scene)
{
    scene.contact.join(collision);
    if (!collision.empty()) startConstraints(scene);
}

} // namespace filasofia::sofaengine
