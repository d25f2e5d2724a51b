#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/engine/body/body_topology.h"
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

/// What is kept of ruptures from step to step. Blades are kept for their lines only.
struct Ruptures {
    std::vector<Blade> blades; ///< ascending
    Topologies topologies;
};

/// Takes out what has fallen so far that it is out of every scene: it would fall for ever, and its body's numbers with
/// it. Systems are outdated then.
void removeLostPieces(Model& model, State& state, Systems& systems, Topologies& topologies,
                      physics::StepReport& report);
/// 5. What blades cut in the step just made. Done in the topologies' meshes: models and states follow in applyEdits.
void cutBodies(const Model& model, double dt, const RigidPlan& rigid, const State& state, Ruptures& ruptures,
               physics::StepReport& report);
/// The same for what stress tears. Bodies must have followed the cuts.
void tearBodies(const Model& model, double dt, const State& state, Systems& systems, Ruptures& ruptures,
                WorkerPool& pool, physics::StepReport& report);

/// 6. The only writer of topology: everything that is kept of a body follows the edits of its mesh.
void applyEdits(double period, Model& model, State& state, Systems& systems, Ruptures& ruptures,
                physics::StepReport& report);

/// Solvers of bodies that were parted learn of it: begun in the step that parted them, known some steps later.
void followPartings(const Model& model, double dt, Systems& systems, BackgroundThread& meanwhile);

} // namespace filasofia::engine
