#pragma once

#include "filasofia/engine/collision/edit_shape.h"
#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// How an edit of a soft body's mesh changes the body's own surface.
struct OwnSurfaceEdit {
    SurfaceEdit surface;
    std::vector<int> nodes = {}; ///< per appended vertex: its node
    /// Per triangle of the edited surface: the fourth node of its tetrahedron, which a cut may have replaced by a copy
    /// though the triangle is as before. Empty: those that are left keep theirs, and none is new.
    std::vector<int> behind = {};
};

/// Applies the edit to a collision model that is the body's own surface, and to the contacts and sides in the scene's
/// state. Those on features that still exist get the new feature numbers; the others are erased. The body must have its
/// new nodes already, and `body.collision[model]` still holds the old surface.
void editCollision(const OwnSurfaceEdit& edit, int model, SoftModel& body, Scene& scene);

} // namespace filasofia::engine
