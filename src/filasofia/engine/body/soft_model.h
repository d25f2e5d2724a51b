#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/body/cavity.h"
#include "filasofia/engine/body/channel.h"
#include "filasofia/engine/body/clip.h"
#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/body/pins.h"
#include "filasofia/engine/body/rod.h"
#include "filasofia/engine/body/shell.h"
#include "filasofia/engine/body/tissue_map.h"
#include "filasofia/engine/elastic/element.h"
#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/engine/elastic/relaxation.h"
#include "filasofia/engine/elastic/spring.h"
#include "filasofia/physics/defs.h"

#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace filasofia::engine {

/// One of the pieces into which a cut or torn body has come apart.
struct BodyPiece {
    int number = 0;            ///< its number in physics::LoosePiece
    std::vector<int> nodes;    ///< ascending
    std::vector<int> elements; ///< ascending; empty unless the piece is a small fragment
    bool held = false;         ///< some of its nodes are pinned
};

/// The properties of a soft body.
struct SoftModel {
    BodyId id;
    std::string name;
    std::vector<Vec3> rest;           ///< [m] nodes at the start, in world coordinates
    Vec3 startVelocity;               ///< [m/s] of all nodes that are not pinned hard
    std::vector<double> masses;       ///< [kg] lumped: equal parts of each tetrahedron or triangle
    std::vector<double> filling;      ///< [kg] the part of these without weight: of liquids in cavities; empty: none
    physics::FemMaterial material;    ///< FEM bodies only; what it says of parts is in the elements
    std::vector<FemElement> elements; ///< FEM bodies only; neighbours are near each other in the list
    std::vector<Spring> springs;      ///< mass-spring bodies only
    std::vector<geometry::Tetrahedron> tetrahedra; ///< mass-spring bodies only; a FEM body has elements
    Shell shell;                                   ///< bodies of triangles only
    Rod rod;                                       ///< rods only
    /// Nodes of the boundary, outwards: pressure acts there. For a shell, all triangles in the order of its mesh; none
    /// for a rod
    std::vector<geometry::Triangle> surface;
    std::vector<Cavity> cavities;
    std::vector<int>
        wallOf; ///< per triangle of `surface`: the cavity whose wall it is; -1: none. Empty without cavities
    Pins pins;
    physics::Rayleigh rayleigh;
    physics::Integrator integrator;
    physics::Solver solver;
    bool gravity = true;
    double friction = 0.0; ///< [-] mu
    std::vector<CollisionModel> collision;
    std::optional<PunctureModel> puncture; ///< none: needles cannot pierce it
    bool dynamicTopology = false;          ///< the body may be cut or torn
    bool opened = false;                   ///< a cut or a tear has parted some of it
    bool leaks = false;                    ///< a closed shell that was opened: its pressure has escaped
    std::vector<BodyPiece> pieces;         ///< ascending by number; empty while the body is whole
    std::set<int> removed;                 ///< removed pieces: their nodes are pinned and have no surface
    double density = 0.0;                  ///< [kg/m^3] of elements for which no region says another
    /// [Pa] the smallest of all elements; infinite: never tears
    double tearingThreshold = std::numeric_limits<double>::infinity();
    /// [Pa] the smallest of all elements; infinite: none ever flows
    double yieldStress = std::numeric_limits<double>::infinity();
    /// FEM bodies only: the mesh of the Def, in which regions and fibres are looked up, and its orientation in the
    /// world
    std::shared_ptr<const geometry::TetMesh> mesh;
    Quat orientation;
    std::shared_ptr<const TissueMap> tissue; ///< FEM bodies only: the material in that mesh
    /// Per family of fibres and element: the direction at rest, in the world; zero: no fibre
    std::vector<std::vector<Vec3>> fibres;
    bool nodalVolumes = false; ///< some elements share their volume with their nodes (nodal_volume.h)
    bool patched = false;      ///< the tissue of some elements was changed after the material was set, or flowed
};

inline bool isRod(const SoftModel& model) { return !model.rod.edges.empty(); }

/// The body's kind and name as errors begin: "soft body 'uterus'".
std::string describe(const SoftModel& model);

/// True if the stress of an element is that of the elastic law: no fibres, no relaxation, no pressure of its nodes.
inline bool hasLawAlone(const SoftModel& model)
{
    return model.fibres.empty() && model.material.relaxation.empty() && !model.nodalVolumes;
}

/// True if blades of a collision group may cut the body.
bool mayBeCut(const SoftModel& model, int group);

/// Positions, velocities and loads of a soft body, per node unless stated otherwise.
struct SoftState {
    std::vector<Vec3> x;  ///< [m]
    std::vector<Vec3> v;  ///< [m/s]
    std::vector<Vec3> dv; ///< [m/s] the last step's change of velocity: first guess of the next solve
    /// Per block of sixteen elements, from the last step: the next polar decomposition starts there.
    std::vector<ElementRotations> rotations;
    std::vector<ElementRelaxation> relaxation; ///< the same; empty if the tissue does not relax
    double unrelaxed = 0.0;     ///< [s] duration of the last step, if the relaxation has not followed it yet
    std::vector<Vec3> residual; ///< [N s] the residual impulse of the last solve that the next step takes over
    int iterations = 0;         ///< that the last step's solve took: the next one prepares for as many
    std::vector<Vec3> forces;   ///< [N] set by the user
    double pressure = 0.0;      ///< [Pa] set by the user
    std::vector<CavityState> cavities;
    std::vector<Clip> clips; ///< on this body, ascending by id
    RodState rod;            ///< rods only
};

/// The rotation of one element.
Quat rotationOf(const std::vector<ElementRotations>& rotations, std::size_t element);
void setRotation(std::vector<ElementRotations>& rotations, std::size_t element, Quat q);

/// The state at the start: its shape at rest, with the velocity of the start, without forces and pressure.
SoftState stateAtStart(const SoftModel& model);

/// Throws an Error that names the body if a size, an index or a number is invalid.
void check(const SoftModel& model, const SoftState& state);

/// What a material says of the tetrahedra of a body; null unless it is a FemMaterial. Throws an Error that names the
/// body if a region or a direction of fibres does not fit its mesh.
std::shared_ptr<const TissueMap> mapTissue(const physics::SoftMaterial& material, const SoftModel& model);
/// Writes a material, and its map in the body's mesh, into every element, spring or triangle of a body that was built
/// with a material of the same kind.
void setMaterial(const physics::SoftMaterial& material, const std::shared_ptr<const TissueMap>& map, SoftModel& model);
/// Takes changes of single elements back.
void healTissue(SoftModel& model);
/// The terms that relax begin with the present stress, as if it had just come about.
void restartRelaxation(const SoftModel& model, SoftState& state);

/// Replaces the nodal forces.
void setForces(const std::vector<physics::NodalForce>& forces, SoftState& state);

} // namespace filasofia::engine
