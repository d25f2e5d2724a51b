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

SceneState stateOf(const SofaScene& scene)
{
    SceneState state{.gravity = fromSofa(scene.root->getGravity())};
    for (const auto& body : scene.soft) {
        body->read(state.soft.emplace_back());
        state.pins.push_back(body->pins());
    }
    for (const auto& body : scene.rigid) body->read(state.rigid.emplace_back());
    for (const auto& tie : scene.ties) state.ties.push_back(tie->id());
    return state;
}

void setState(const SceneState& state, SofaScene& scene)
{
    scene.root->setGravity(toSofa(state.gravity));
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        scene.soft[b]->write(state.soft[b]);
        scene.soft[b]->setPins(state.pins[b]);
    }
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) scene.rigid[b]->write(state.rigid[b]);
}

} // namespace filasofia::sofaengine
