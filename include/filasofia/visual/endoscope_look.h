#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/visual/visual_server.h"

namespace filasofia::visual {

/// The box around a mesh's vertices. Throws an Error when there are none.
geometry::Box boundsOf(const geometry::TriangleMesh& mesh);

/// What addEndoscopeLook made. Camera and light hang on the rig: move the rig.
struct EndoscopeLook {
    Transform* rig = nullptr;
    Camera* camera = nullptr;
    Light* light = nullptr;
    View* view = nullptr;
};

/// The picture of an endoscope that looks at `around` from `direction` (from the box towards the camera, any length but
/// 0): a camera that frames the box, a cold light beside its lens, dim surroundings, and a view of the whole window.
/// Intensities grow with the square of the distance, so that any size of box is exposed alike.
/// Throws an Error when the box is empty or not finite.
EndoscopeLook addEndoscopeLook(VisualServer& server, const geometry::Box& around, Quality quality = Quality::High,
                               Vec3 direction = {0.25, 0.3, 1.0});

} // namespace filasofia::visual
