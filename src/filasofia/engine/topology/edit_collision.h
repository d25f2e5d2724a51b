#pragma once

#include "filasofia/engine/collision/edit_shape.h"
#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// What an edit of a soft body's mesh does to its own surface.
struct OwnSurfaceEdit {
    SurfaceEdit surface;
    std::vector<int> nodes = {};  ///< per appended vertex: the node that it is
    std::vector<int> behind = {}; ///< per changed, then per added triangle: the fourth node of its tetrahedron
};

/// Carries the edit into a collision model that is the body's own surface, and into what the state knows of it: what
/// contacts and sides tell of features that are left goes over to their new numbers, of others it goes. The body has
/// its new nodes already; the surface of the old model is in `body`, at that place.
void editCollision(const OwnSurfaceEdit& edit, int model, SoftModel& body, Scene& scene);

} // namespace filasofia::engine
