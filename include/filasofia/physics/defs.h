#pragma once

#include "filasofia/physics/cavity_def.h"
#include "filasofia/physics/fem_material.h"
#include "filasofia/physics/needle_def.h"
#include "filasofia/physics/node_def.h"
#include "filasofia/physics/rigid_body_def.h"
#include "filasofia/physics/rod_body_def.h"
#include "filasofia/physics/shell_material.h"

#include "filasofia/geometry/tet_mesh.h"

#include <limits>

/// The Defs of soft bodies. Every member has a default, a unit and a legal range; the fields() lists give them to
/// programs. Building a body checks all of them.
namespace filasofia::physics {

/// Equal springs with dashpots on all edges of the mesh.
struct MassSpringMaterial {
    double stiffness = 100.0; ///< [N/m], > 0, of each spring
    double damping = 0.0;     ///< [N s/m], >= 0, of each dashpot, along the spring
    /// [Pa], > 0 or infinite, as for FemMaterial. The stress of a tetrahedron follows from the forces of its springs by
    /// the virial formula, (1/V) sum f (x) r over its six edges, with each spring's force divided among the tetrahedra
    /// around it.
    double tearingThreshold = std::numeric_limits<double>::infinity();
};

using SoftMaterial = std::variant<FemMaterial, MassSpringMaterial, ShellMaterial>;

/// v' = v + dt M^-1 f(x, v), x' = x + dt v: cheap, but unstable unless steps are small.
struct ExplicitEuler {
    bool symplectic = false; ///< x' = x + dt v' instead: keeps the energy bounded
};
/// Backward Euler, linearised once per step (Baraff and Witkin 1998).
struct ImplicitEuler {};
using Integrator = std::variant<ImplicitEuler, ExplicitEuler>;

/// Iterative: conjugate gradients, started from the last step's solution. With `assembled`, iterations continue past a
/// step's deadline.
struct ConjugateGradient {
    int maxIterations = 300; ///< [-], in [1, 100000]
    double tolerance =
        5e-3; ///< [-], in (0, 1), error of a step's solution relative to the solution, in the energy norm; a solution
              ///< that accelerates by less than 0.1 m/s^2 counts as one that does (docs/design/solver.md)
    int minIterations =
        4; ///< [-], in [0, 100000], iterations before a deadline may end the solve: this keeps the energy from growing
    bool assembled = false; ///< the reference solver: the whole matrix, in double precision. Many times slower.
};
/// Direct: sparse Cholesky, factorised in every step. Continues past a step's deadline, however long it takes.
struct Cholesky {};
using Solver = std::variant<ConjugateGradient, Cholesky>;

/// A mesh of tetrahedra or, for a shell, of triangles: the name of a file, or the mesh itself.
using SoftMeshSource =
    std::variant<std::string, std::shared_ptr<const geometry::TetMesh>, std::shared_ptr<const geometry::TriangleMesh>>;

/// A body that deforms.
struct SoftBodyDef {
    std::string name = "soft body";
    /// Triangles with a ShellMaterial, otherwise tetrahedra. Every vertex of a shell belongs to a triangle, an edge to
    /// one or two, and neighbours face the same way.
    SoftMeshSource mesh = {};
    Pose pose = {}; ///< from the mesh's coordinates to the world
    SoftMaterial material = FemMaterial{};
    Mass mass = Density{};
    Rayleigh rayleigh = {};
    Vec3 velocity = {};  ///< [m/s], initial, of all nodes that are not pinned
    bool gravity = true; ///< whether gravity acts on it
    Integrator integrator = ImplicitEuler{};
    Solver solver = ConjugateGradient{};
    std::vector<AttachmentDef> attachments = {};
    std::vector<NodalForce> forces = {}; ///< until changed by a command
    /// [Pa], on the whole surface but for the walls of its cavities, positive pushes inwards; on a shell against its
    /// normals, until a cut opens a closed one
    double pressure = 0.0;
    std::vector<CollisionDef> collision = {}; ///< its collision models; none: it collides with nothing
    double friction = 0.3; ///< [-], >= 0, Coulomb's mu; a pair of bodies uses the square root of the product of both
    /// Whether it may be cut and may tear, so that its elements change during the run. Blades are rigid bodies with a
    /// collision model that has `cutting` set.
    bool dynamicTopology = false;
    std::optional<PunctureDef> puncture = {}; ///< how it resists needles; none: they cannot pierce it
    /// Spaces that its surface encloses, and what fills them; ImplicitEuler and the default solver only
    std::vector<CavityDef> cavities = {};
};

using BodyDef = std::variant<SoftBodyDef, RigidBodyDef, RodBodyDef>;

/// Whether a body consists of rigid elements; all others consist of nodes.
inline bool isRigid(const BodyDef& def) { return std::holds_alternative<RigidBodyDef>(def); }

constexpr auto fields(const MassSpringMaterial*)
{
    using T = MassSpringMaterial;
    return describe("MassSpringMaterial",
                    field("stiffness", &T::stiffness, "N/m", positive(), "stiffness of each spring"),
                    field("damping", &T::damping, "N s/m", nonNegative(), "damping of each spring"),
                    field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(),
                          "largest principal stress beyond which it tears"));
}
constexpr auto fields(const ExplicitEuler*)
{
    return describe("ExplicitEuler",
                    field("symplectic", &ExplicitEuler::symplectic, "update positions with the new velocity"));
}
constexpr auto fields(const ImplicitEuler*) { return describe("ImplicitEuler"); }
constexpr auto fields(const ConjugateGradient*)
{
    using T = ConjugateGradient;
    return describe(
        "ConjugateGradient",
        field("maxIterations", &T::maxIterations, "-", closed(1, 100000), "largest number of iterations per step"),
        field("tolerance", &T::tolerance, "-", open(0, 1), "relative error of a step's solution in the energy norm"),
        field("minIterations", &T::minIterations, "-", closed(0, 100000),
              "iterations before a deadline may end the solve"),
        field("assembled", &T::assembled, "the reference solver: the whole matrix, in double precision"));
}
constexpr auto fields(const Cholesky*) { return describe("Cholesky"); }
constexpr auto fields(const SoftBodyDef*)
{
    using T = SoftBodyDef;
    return describe("SoftBodyDef", field("name", &T::name, "its name in errors and reports"),
                    field("mesh", &T::mesh, "a mesh file, or the mesh"),
                    field("pose", &T::pose, "from the mesh's coordinates to the world"),
                    field("material", &T::material, "elastic law"), field("mass", &T::mass, "density or total mass"),
                    field("rayleigh", &T::rayleigh, "Rayleigh damping"),
                    field("velocity", &T::velocity, "m/s", finite(), "initial velocity of all nodes"),
                    field("gravity", &T::gravity, "whether gravity acts on it"),
                    field("integrator", &T::integrator, "time integration"),
                    field("solver", &T::solver, "solver of the step's linear system"),
                    field("attachments", &T::attachments, "attachments of its nodes"),
                    field("forces", &T::forces, "prescribed nodal forces"),
                    field("pressure", &T::pressure, "Pa", finite(), "pressure on the whole surface, positive inwards"),
                    field("collision", &T::collision, "its collision models"),
                    field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction),
                          "friction coefficient mu of Coulomb's law"),
                    field("dynamicTopology", &T::dynamicTopology, "whether it may be cut and may tear"),
                    field("puncture", &T::puncture, "how it resists needles; none: they cannot pierce it"),
                    field("cavities", &T::cavities, "spaces that its surface encloses, and what fills them"));
}
/// The body's kind and name as errors begin: "soft body 'uterus'".
std::string describeBody(const BodyDef& def);

/// Whether there is something of it to draw: all but a rigid body without a mesh.
bool hasSurface(const BodyDef& def);

/// The pose with its orientation scaled to unit length; throws an Error naming `object` if the orientation has no
/// length.
Pose unitPose(const Pose& pose, std::string_view object);

/// The mesh of a body, read from its file if the Def names one, and checked. Throws an Error naming the body, also if
/// it is a shell.
std::shared_ptr<const geometry::TetMesh> loadMesh(const SoftBodyDef& def);

/// That mesh in the body's initial pose: nodes in world coordinates.
geometry::TetMesh worldMesh(const SoftBodyDef& def);

/// Whether a body consists of triangles.
bool isShell(const SoftBodyDef& def);

/// The same two for a shell.
std::shared_ptr<const geometry::TriangleMesh> loadShell(const SoftBodyDef& def);
geometry::TriangleMesh worldShell(const SoftBodyDef& def);

/// A surface, read from its file if its source names one, and checked; null if none is given. Throws an Error that
/// begins with `object`.
std::shared_ptr<const geometry::TriangleMesh> loadMesh(const TriangleMeshSource& source, std::string_view object);

/// The same Def with meshes in place of file names. Throws an Error naming the body.
SoftBodyDef loaded(SoftBodyDef def);
RigidBodyDef loaded(RigidBodyDef def);

/// The number of its elements: those listed, or the base and one link per joint.
std::size_t elementCount(const RigidBodyDef& def);
/// [rad] or [m] Where a joint starts; with a mimic, where the other joint takes it.
double startOf(const std::vector<JointDef>& joints, std::size_t joint);
struct JointLimits {
    double lower = 0.0, upper = 0.0; ///< [rad] or [m]; upper < lower: nothing is left
};
/// The limits of a joint, within which those that mimic it are within theirs.
JointLimits limitsOf(const std::vector<JointDef>& joints, std::size_t joint);

/// The initial poses of its elements: the poses listed, and for links the poses that follow from their joints.
std::vector<Pose> elementPoses(const RigidBodyDef& def);

/// Throws an Error naming the body and the field for errors that a range cannot express: elements that do not exist, a
/// missing mesh, impossible moments of inertia. Does not look into meshes.
void check(const BodyDef& def);

/// The inertia of one element.
struct RigidInertia {
    double mass = 0.0; ///< [kg]; 0 if the body is not dynamic
    Vec3 centre = {};  ///< [m] centre of mass, in the element's coordinates; their origin if it has no mass
    Mat3 inertia = {}; ///< [kg m^2] about the centre of mass, along the element's axes
};
/// As given in the Def, or computed from its mesh and density. Throws an Error naming the body, for example if the mesh
/// is not closed.
RigidInertia inertiaOf(const RigidBodyDef& def);

/// The inertia of every link of an articulated body, including the base: that of the joint that moves it, or that of
/// the body. A link without either gets zeros: it moves only as its joints do, and no force can move it.
std::vector<RigidInertia> linkInertias(const RigidBodyDef& def);

/// Whether a force may command a joint: it needs an inertia.
bool takesForce(const JointDef& joint, const RigidInertia& child);

} // namespace filasofia::physics
