#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/attachment/pins.h"
#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/engine/elastic/spring.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/physics/defs.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// What the engine knows. The model says what the bodies are and changes only between steps; the state says where they
/// are. Same order of bodies in both, by rising id. Seen from outside only through native.h.
namespace filasofia::engine {

/// What a soft body is.
struct SoftModel {
    BodyId id;
    std::string name;
    std::vector<Vec3> rest;                  ///< [m] nodes at the start, in world coordinates
    std::vector<double> masses;              ///< [kg] lumped, a quarter of each tetrahedron to each node
    std::vector<FemElement> elements;        ///< of a FEM body, neighbours near each other in the list
    std::vector<Spring> springs;             ///< of a mass-spring body
    std::vector<geometry::Triangle> surface; ///< boundary, by nodes, outwards: where pressure acts
    Pins pins;
    physics::Rayleigh rayleigh;
    physics::Integrator integrator;
    physics::Solver solver;
    bool gravity = true;
};

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

/// A rigid body: the poses it was added with.
struct RigidModel {
    BodyId id;
    std::string name;
    std::vector<Pose> rest;
};

struct RigidState {
    std::vector<Pose> poses; ///< per element
};

struct Model {
    std::vector<SoftModel> softBodies;
    std::vector<RigidModel> rigidBodies;
};

struct State {
    std::uint64_t step = 0;
    double time = 0.0; ///< [s]
    Vec3 gravity;      ///< [m/s^2]
    std::vector<SoftState> softBodies;
    std::vector<RigidState> rigidBodies;
};

/// The rotation of one element.
Quat rotationOf(const std::vector<ElementRotations>& rotations, std::size_t element);
void setRotation(std::vector<ElementRotations>& rotations, std::size_t element, Quat q);

/// The start: at rest, with the given forces.
SoftState stateAtRest(const SoftModel& model);

/// True where every number is finite and within physics::kFarthest.
bool usable(std::span<const Vec3> values);

/// Throws an Error naming the body unless every size, index and number can be stepped with.
void check(const SoftModel& model, const SoftState& state);
void check(const RigidModel& model, const RigidState& state);

} // namespace filasofia::engine
