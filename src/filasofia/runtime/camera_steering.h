#pragma once

#include "filasofia/event/event.h"
#include "filasofia/visual/orbit_camera.h"

#include <memory>
#include <optional>

namespace filasofia::visual {
class Transform;
}

namespace filasofia::runtime {

class Bindings;

/// The camera that the person at the window moves, if there is one. Main thread.
class CameraSteering {
public:
    /// Steers this camera, or the rig that carries it, from now on. Error if it is not one of the visual server's or
    /// has a parent.
    void begin(visual::Transform& camera, const visual::OrbitDef& def, const Bindings& bindings);
    /// Moves the camera if the event is meant for it.
    void handle(const event::Event& event, const Bindings& bindings);
    void end() { steered_.reset(); }

private:
    struct Steered {
        visual::OrbitCamera orbit;
        visual::Transform* transform = nullptr;
        std::weak_ptr<const void> life = {}; ///< expires when the transform is destroyed
    };
    std::optional<Steered> steered_;
};

} // namespace filasofia::runtime
