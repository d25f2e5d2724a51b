#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/body/pins.h"
#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/engine/elastic/spring.h"
#include "filasofia/physics/defs.h"

#include <limits>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace filasofia::engine {

/// One of the pieces that a cut body has fallen into.
struct BodyPiece {
    int number = 0;            ///< as physics::LoosePiece tells it
    std::vector<int> nodes;    ///< ascending
    std::vector<int> elements; ///< ascending; of a crumb, else none
    bool held = false;         ///< pins hold some of its nodes
};

/// What a soft body is.
struct SoftModel {
    BodyId id;
    std::string name;
    std::vector<Vec3> rest;                        ///< [m] nodes at the start, in world coordinates
    std::vector<double> masses;                    ///< [kg] lumped, a quarter of each tetrahedron to each node
    std::vector<FemElement> elements;              ///< of a FEM body, neighbours near each other in the list
    std::vector<Spring> springs;                   ///< of a mass-spring body
    std::vector<geometry::Tetrahedron> tetrahedra; ///< of a mass-spring body; a FEM body has elements
    std::vector<geometry::Triangle> surface;       ///< boundary, by nodes, outwards: where pressure acts
    Pins pins;
    physics::Rayleigh rayleigh;
    physics::Integrator integrator;
    physics::Solver solver;
    bool gravity = true;
    double friction = 0.0; ///< [-] mu
    std::vector<CollisionModel> collision;
    bool dynamicTopology = false;  ///< it may be cut and tear
    std::vector<BodyPiece> pieces; ///< by rising number; none while it is whole
    std::set<int> removed;         ///< pieces that were taken out: their nodes are held, and have no surface
    double density = 0.0;          ///< [kg/m^3] what its elements weigh, where they change
    double tearingThreshold = std::numeric_limits<double>::infinity(); ///< [Pa]
};

/// Whether blades of a collision group may cut a body.
bool mayBeCut(const SoftModel& model, int group);

/// Where a soft body is, and what pushes it. All per node unless said.
struct SoftState {
    std::vector<Vec3> x;  ///< [m]
    std::vector<Vec3> v;  ///< [m/s]
    std::vector<Vec3> dv; ///< [m/s] the last step's change: where the next solve starts
    std::vector<ElementRotations>
        rotations;              ///< of sixteen elements each, the last step's: where the next search starts
    std::vector<Vec3> leftover; ///< [N s] the impulse that the last solve left undone, due in the next step
    std::vector<Vec3> forces;   ///< [N] given
    double pressure = 0.0;      ///< [Pa] given
};

/// The rotation of one element.
Quat rotationOf(const std::vector<ElementRotations>& rotations, std::size_t element);
void setRotation(std::vector<ElementRotations>& rotations, std::size_t element, Quat q);

/// The start: at rest, with the given forces.
SoftState stateAtRest(const SoftModel& model);

/// Throws an Error naming the body unless every size, index and number can be stepped with.
void check(const SoftModel& model, const SoftState& state);

/// Writes a material into every element or spring of a body that was made with one of the same kind.
void setMaterial(const physics::SoftMaterial& material, SoftModel& model);

/// Replaces the given forces.
void setForces(const std::vector<physics::NodalForce>& forces, SoftState& state);

} // namespace filasofia::engine
