#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/visual/visual_server.h"

#include <span>

namespace filasofia::visual {

/// The box around a mesh's vertices. Throws an Error if there are none.
geometry::Box boundsOf(const geometry::TriangleMesh& mesh);

/// The entities that addEndoscopeLook made. The rig is the parent of camera and light: move the rig.
struct EndoscopeLook {
    Transform* rig = nullptr;
    Camera* camera = nullptr;
    Light* light = nullptr;
    View* view = nullptr;
};

/// The picture of an endoscope that looks at `around` from `direction` (from the box towards the camera, any length but
/// 0): a camera that frames the box, a cold light beside its lens, dim surroundings, and a view of the whole window.
/// Intensities grow with the square of the distance, so that a box of any size is exposed alike.
/// Throws an Error if the box is empty or not finite.
EndoscopeLook addEndoscopeLook(VisualServer& server, const geometry::Box& around, Quality quality = Quality::High,
                               Vec3 direction = {0.25, 0.3, 1.0});

/// The box, grown about its middle as far as the look at it needs to have all of `points` [m], in the world, in a
/// picture with this aspect (width over height, > 0). A box around points that fit is as it is.
geometry::Box framing(const geometry::Box& around, std::span<const Vec3> points, double aspect,
                      Vec3 direction = {0.25, 0.3, 1.0});

} // namespace filasofia::visual
