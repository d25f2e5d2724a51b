#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/geometry/box.h"

namespace filasofia::engine {

/// A collision model that cuts, and where its vertices are at the end and were at the start of the step.
struct Blade {
    SurfaceName name;
    std::shared_ptr<const CollisionShape> shape;
    std::vector<std::array<int, 2>> lines;   ///< its edges, by vertices
    std::vector<Vec3> before = {}, now = {}; ///< [m]
    bool jumped = false;                     ///< farther than is believed: it has no way
    geometry::Box swept = {};                ///< where it was told to go from, and to
};

/// Removes pieces that have fallen out of the scene: they would fall for ever, and their body's numbers with them.
/// Their systems are outdated then.
void removeLostPieces(Scene& scene, physics::StepReport& report);

/// Cuts what blades were drawn through in the step just made. The topologies' meshes are cut; models and states follow
/// in applyEdits(). `blades` are kept from step to step for their lines only, ascending.
void cutBodies(const StepContext& context, const RigidPlan& rigid, Scene& scene, std::vector<Blade>& blades);
/// The same for what stress tears. Bodies must have followed the cuts.
void tearBodies(const StepContext& context, Scene& scene);

/// The only writer of topology: everything that is kept of a body follows the edits of its mesh. `period` [s]: the step
/// that solvers prepare for.
void applyEdits(double period, Scene& scene, physics::StepReport& report);

/// Lets the solvers of bodies that were parted learn of it: begun in the step that parted them, known some steps later.
void followPartings(double dt, Scene& scene, BackgroundThread& meanwhile);

} // namespace filasofia::engine
