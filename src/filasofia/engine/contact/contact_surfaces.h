#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/step_context.h"

#include <string>
#include <vector>

namespace filasofia::engine {

/// The body and element that a surface belongs to.
struct SurfaceOwner {
    bool soft = true;
    std::size_t body = 0; ///< index among the bodies of its kind
    std::size_t plan = 0; ///< rigid bodies only: index of its element in the plan
    SurfaceName name;
    const CollisionModel* collision = nullptr;
};

/// The owners of all surfaces that take part in contacts, soft bodies first.
std::vector<SurfaceOwner> surfaceOwners(const Scene& scene);
/// Whether constraints can move the owner.
inline bool movable(const SurfaceOwner& owner, const RigidPlan& plan) { return owner.soft || plan[owner.plan].dynamic; }
const std::string& nameOf(const Scene& scene, const SurfaceOwner& owner);
/// Appends, per vertex of a collision model, its piece (CollisionSurface::pieceOf). Small fragments meet nothing of
/// their own body unless the Def says so: they would cost more than anyone sees of them.
void findPieces(const SoftModel& model, const CollisionModel& collision, std::vector<int>& pieceOf);
/// Whether the body need not meet itself in this surface, its own, because it does so in another one, at the same
/// place.
bool isSpared(const SoftModel& model, const CollisionModel& collision);
/// Whether the surface is the centre line of a rod.
bool isLine(const Scene& scene, const SurfaceOwner& owner);

/// The mean of the nodes' values that a vertex of a soft body's surface follows.
Vec3 valueAt(std::size_t vertex, const geometry::Embedding& embedding, const std::vector<Vec3>& values);

/// [m] The inset of a surface at the place of a proximity.
double insetAt(const CollisionModel& collision, const Proximity& found, std::size_t side);

/// Updates every surface to its body's state, and warns of models that cannot work; blades among them are reported.
/// Returns per surface whether it is new; empty if none is.
std::vector<bool> placeSurfaces(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                                Coupling& coupling);

} // namespace filasofia::engine
