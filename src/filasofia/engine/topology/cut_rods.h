#pragma once

#include "filasofia/engine/topology/ruptures.h"

/// Rods are cut at whole edges: an edge that a blade crosses is gone. Nodes keep their numbers, positions, velocities
/// and masses, so momentum is kept, and whatever names a node goes on. What is lost is the stiffness of one edge, and
/// what is seen of it.
namespace filasofia::engine {

/// Finds the edges of a rod that blades have crossed in the step just made.
void findRodCuts(const std::vector<Blade>& blades, SoftBody& body, physics::TopologyReport& report);

/// Finds the edges that tension tears: in each piece that with the largest tension, if it is beyond the break force.
void findRodTears(SoftBody& body);

/// Takes the edges out that were found. Attached points go with the side of the cut that they are on; channels in which
/// the rod was cut become two.
void applyRodCuts(SoftBody& body, Scene& scene, physics::TopologyReport& report);

/// Makes the collision model of a rod that of the edges and nodes that are left.
void cutRodCollision(SoftModel& model, Scene& scene);

} // namespace filasofia::engine
