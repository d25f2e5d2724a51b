#include "filasofia/runtime/camera_steering.h"

#include "filasofia/core/error.h"
#include "filasofia/runtime/bindings.h"
#include "filasofia/visual/visual_server.h"

namespace filasofia::runtime {

void CameraSteering::begin(visual::Transform& camera, const visual::OrbitDef& def, const Bindings& bindings)
{
    if (!bindings.visual() || !bindings.visual()->has(camera))
        fail("steer: the camera does not belong to the visual server, or there is no visual server yet");
    if (camera.parent())
        fail("steer: '", camera.name(), "' has the parent '", camera.parent()->name(), "': steer the parent");
    steered_ = Steered{visual::OrbitCamera(def), &camera, camera.life()};
    camera.setPose(steered_->orbit.pose());
}

void CameraSteering::handle(const event::Event& event, const Bindings& bindings)
{
    if (!steered_) return;
    if (steered_->life.expired()) return end();
    const auto* key = dynamic_cast<const event::KeyEvent*>(&event);
    if (key && key->key == event::KeyCode::F) steered_->orbit.setScene(bindings.boundsNow());
    if (steered_->orbit.handle(event)) steered_->transform->setPose(steered_->orbit.pose());
}

} // namespace filasofia::runtime
