#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// A contact that detection has not foreseen: in the step as it was solved, surfaces would pass through each other.
struct MissedContact {
    Proximity at = {};                      ///< as it is at the start of the step
    bool line = false;                      ///< part of a plane that keeps a line apart: no friction
    std::array<std::size_t, 2> bodies = {}; ///< between two lines, or at a shell: indices in Scene::soft
    double mayLose = 0.0;                   ///< [m] at a shell: by how much the two places may come nearer
};

/// [m] From the nearest place on the second edge to that on the first.
Vec3 betweenEdges(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// The corners of an edge, a triangle or a point of a surface as they are now; -1: unused.
struct FeatureCorners {
    int surface = 0; ///< index
    std::array<int, 3> vertices{-1, -1, -1};
    std::array<Vec3, 3> x{}; ///< [m]
};
/// Adds contacts that keep two features on both sides of a plane across `between` [m], from the nearest place on the
/// second one to that on the first. One contact at the places that would meet is not enough: edges that lie along each
/// other would meet beside it. `across`: the plane's normal if the features touch. `radii` [m]: of what is around them.
void addPlane(const FeatureCorners& one, const FeatureCorners& two, Vec3 between, Vec3 across, double radii,
              std::array<std::size_t, 2> bodies, std::vector<MissedContact>& out);

/// Tests all pairs of edges of rods that collide, with the velocities that the solve has given them. A thread weighs
/// milligrams, so contacts cannot be foreseen from how fast it was: one that snaps back moves by many diameters in the
/// step in which it begins to move.
std::vector<MissedContact> findLinePasses(double dt, const Scene& scene, const Coupling& coupling);

/// If a rod moves farther than detection has foreseen, detects anew with its velocity in the solved step. Returns the
/// contacts with anything but lines that are new and would be violated.
std::vector<MissedContact> findUnforeseen(const StepContext& context, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
