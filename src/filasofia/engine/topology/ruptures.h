#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/geometry/box.h"

namespace filasofia::engine {

/// A collision model that cuts, with the positions of its vertices at the start and the end of the step.
struct Blade {
    SurfaceName name;
    std::shared_ptr<const CollisionShape> shape;
    std::vector<std::array<int, 2>> lines;   ///< its cutting edges, by vertices
    std::vector<Vec3> before = {}, now = {}; ///< [m]
    bool jumped = false;                     ///< it moved further than allowed in a step: it has no path
    geometry::Box swept = {};                ///< around its positions at the start and the end
};

/// Removes pieces that have fallen out of the scene. They would fall for ever, and the numbers of their body would grow
/// without bound. The systems of these bodies are then marked as outdated.
void removeLostPieces(Scene& scene, physics::StepReport& report);

/// Cuts along the paths of the blades in the step just made. This edits only the meshes of the topologies; models and
/// states follow in applyEdits(). `blades`, ascending, is kept between steps only for its lines.
void cutBodies(const StepContext& context, const RigidPlan& rigid, Scene& scene, std::vector<Blade>& blades);
/// The same for tears by stress. Cuts must have been applied to the bodies before.
void tearBodies(const StepContext& context, Scene& scene);

/// The only writer of topology: carries the edits of a body's mesh over to everything that is kept about the body.
/// `period` [s] is the step that solvers prepare for.
void applyEdits(double period, Scene& scene, physics::StepReport& report);

/// Updates the solvers of bodies that were separated. The work begins in the step of the separation, and its result is
/// used some steps later.
void followPartings(double dt, Scene& scene, BackgroundThread& meanwhile);

} // namespace filasofia::engine
