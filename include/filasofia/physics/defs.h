#pragma once

#include "filasofia/physics/rigid_body_def.h"

#include "filasofia/geometry/tet_mesh.h"

#include <limits>

/// What a user asks for. Every member has a default, a unit and a legal range; the fields() lists beside them say so
/// to programs. Building a body checks every one.
namespace filasofia::physics {

/// Linear elastic tissue in large rotation: corotational tetrahedra (Mueller and Gross 2004; polar rotation).
struct FemMaterial {
    double youngModulus = 10e3; ///< [Pa], > 0
    double poissonRatio = 0.45; ///< [-], in [0, 0.5)
    /// [Pa], > 0 or infinite: where the largest principal Cauchy stress is more, elements separate. Needs
    /// dynamicTopology.
    double tearingThreshold = std::numeric_limits<double>::infinity();
};

/// Springs with dashpots on the mesh's edges, all alike.
struct MassSpringMaterial {
    double stiffness = 100.0; ///< [N/m], > 0, of each spring
    double damping = 0.0;     ///< [N s/m], >= 0, of each dashpot, along the spring
    /// [Pa], > 0 or infinite: as of FemMaterial. The stress of a tetrahedron follows from the forces of its springs by
    /// the virial formula, (1/V) sum f (x) r over its six edges, each spring's force shared by the tetrahedra around
    /// it.
    double tearingThreshold = std::numeric_limits<double>::infinity();
};

using SoftMaterial = std::variant<FemMaterial, MassSpringMaterial>;

/// Rayleigh damping: the damping matrix is mass * M + stiffness * K.
struct Rayleigh {
    double mass = 0.1;       ///< [1/s], >= 0
    double stiffness = 0.01; ///< [s], >= 0
};

/// v' = v + dt M^-1 f(x, v), x' = x + dt v: cheap, and unstable for all but small steps.
struct ExplicitEuler {
    bool symplectic = false; ///< x' = x + dt v' instead: keeps energy bounded
};
/// Backward Euler, linearised once per step (Baraff and Witkin 1998).
struct ImplicitEuler {};
using Integrator = std::variant<ImplicitEuler, ExplicitEuler>;

/// Iterative: conjugate gradients from the last step's answer. Assembled, they go on past a step's deadline.
struct ConjugateGradient {
    int maxIterations = 300; ///< [-], in [1, 100000]
    double tolerance = 5e-3; ///< [-], in (0, 1), error of a step relative to its answer, by energy
    int minIterations = 4; ///< [-], in [0, 100000], made before a deadline may end the solve: keeps energy from growing
    bool assembled = false; ///< the reference: the whole matrix, in double precision. Many times slower.
};
/// Direct: sparse Cholesky, factorised every step. Goes on past a step's deadline, however long it takes.
struct Cholesky {};
using Solver = std::variant<ConjugateGradient, Cholesky>;

/// A given force on a node.
struct NodalForce {
    int node = 0;    ///< index of the mesh
    Vec3 force = {}; ///< [N]
};

/// A tetrahedral mesh: the name of a file, or the mesh itself.
using TetMeshSource = std::variant<std::string, std::shared_ptr<const geometry::TetMesh>>;

/// A body that deforms.
struct SoftBodyDef {
    std::string name = "soft body";
    TetMeshSource mesh = {};
    Pose pose = {}; ///< from the mesh's coordinates to the world
    SoftMaterial material = FemMaterial{};
    Mass mass = Density{};
    Rayleigh rayleigh = {};
    bool gravity = true; ///< does gravity act on it
    Integrator integrator = ImplicitEuler{};
    Solver solver = ConjugateGradient{};
    std::vector<AttachmentDef> attachments = {};
    std::vector<NodalForce> forces = {};      ///< until changed by a command
    double pressure = 0.0;                    ///< [Pa], on the whole surface, positive pushes inwards
    std::vector<CollisionDef> collision = {}; ///< by what it is touched; none: nothing touches it
    double friction = 0.3; ///< [-], >= 0, mu; two bodies that touch have the root of the product of theirs
    /// May it be cut, and tear: its elements then change during the run. Blades are rigid bodies with a collision model
    /// that has `cutting` set.
    bool dynamicTopology = false;
};

using BodyDef = std::variant<SoftBodyDef, RigidBodyDef>;

constexpr auto fields(const FemMaterial*)
{
    using T = FemMaterial;
    return describe("FemMaterial", field("youngModulus", &T::youngModulus, "Pa", positive(), "stiffness of the tissue"),
                    field("poissonRatio", &T::poissonRatio, "-", closedOpen(0, 0.5), "0.5 would be incompressible"),
                    field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(), "it tears beyond"));
}
constexpr auto fields(const MassSpringMaterial*)
{
    using T = MassSpringMaterial;
    return describe("MassSpringMaterial",
                    field("stiffness", &T::stiffness, "N/m", positive(), "stiffness of each spring"),
                    field("damping", &T::damping, "N s/m", nonNegative(), "damping of each spring"),
                    field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(), "it tears beyond"));
}
constexpr auto fields(const Rayleigh*)
{
    using T = Rayleigh;
    return describe("Rayleigh", field("mass", &T::mass, "1/s", nonNegative(), "damping per mass"),
                    field("stiffness", &T::stiffness, "s", nonNegative(), "damping per stiffness"));
}
constexpr auto fields(const ExplicitEuler*)
{
    return describe("ExplicitEuler", field("symplectic", &ExplicitEuler::symplectic, "move with the new velocity"));
}
constexpr auto fields(const ImplicitEuler*) { return describe("ImplicitEuler"); }
constexpr auto fields(const ConjugateGradient*)
{
    using T = ConjugateGradient;
    return describe("ConjugateGradient",
                    field("maxIterations", &T::maxIterations, "-", closed(1, 100000), "iterations per step at most"),
                    field("tolerance", &T::tolerance, "-", open(0, 1), "error of a step, by energy"),
                    field("minIterations", &T::minIterations, "-", closed(0, 100000), "made in spite of a deadline"),
                    field("assembled", &T::assembled, "the whole matrix, in double precision: the reference"));
}
constexpr auto fields(const Cholesky*) { return describe("Cholesky"); }
constexpr auto fields(const NodalForce*)
{
    using T = NodalForce;
    return describe("NodalForce", field("node", &T::node, "-", nonNegative(), "index of the node"),
                    field("force", &T::force, "N", finite(), "force on it"));
}
constexpr auto fields(const SoftBodyDef*)
{
    using T = SoftBodyDef;
    return describe(
        "SoftBodyDef", field("name", &T::name, "what errors and reports call it"),
        field("mesh", &T::mesh, "a mesh file, or the mesh"),
        field("pose", &T::pose, "from the mesh's coordinates to the world"),
        field("material", &T::material, "how it resists deformation"), field("mass", &T::mass, "density or total mass"),
        field("rayleigh", &T::rayleigh, "damping"), field("gravity", &T::gravity, "does gravity act on it"),
        field("integrator", &T::integrator, "how a step is made"),
        field("solver", &T::solver, "how the step's equations are solved"),
        field("attachments", &T::attachments, "what holds its nodes"), field("forces", &T::forces, "given forces"),
        field("pressure", &T::pressure, "Pa", finite(), "on the whole surface, positive inwards"),
        field("collision", &T::collision, "by what it is touched"),
        field("friction", &T::friction, "-", nonNegative(), "mu of Coulomb's law"),
        field("dynamicTopology", &T::dynamicTopology, "may it be cut, and tear"));
}
/// The body's kind and name as errors begin: "soft body 'uterus'".
std::string describeBody(const BodyDef& def);

/// The pose with its orientation scaled to unit length; an Error naming `object` where it has no direction.
Pose unitPose(const Pose& pose, std::string_view object);

/// The mesh a body asks for, read from its file where it names one, and checked. Throws an Error naming the body.
std::shared_ptr<const geometry::TetMesh> loadMesh(const SoftBodyDef& def);

/// That mesh where the body starts: nodes in world coordinates.
geometry::TetMesh worldMesh(const SoftBodyDef& def);

/// A surface, read from its file where its source names one, and checked; null where none is given. Throws an Error
/// that begins with `object`.
std::shared_ptr<const geometry::TriangleMesh> loadMesh(const TriangleMeshSource& source, std::string_view object);

/// The same body with its meshes in place of their files' names. Throws an Error naming the body.
SoftBodyDef loaded(SoftBodyDef def);
RigidBodyDef loaded(RigidBodyDef def);

/// How many elements it has: those listed, or the base and a link per joint.
std::size_t elementCount(const RigidBodyDef& def);

/// Where its elements are at the start: the poses listed, and links where their joints put them.
std::vector<Pose> elementPoses(const RigidBodyDef& def);

/// Throws an Error naming the body and the field for what one number's range cannot say: elements that are none, a
/// mesh that is missing, moments of inertia that no body has. Does not look into meshes.
void check(const BodyDef& def);

/// What one element weighs.
struct RigidInertia {
    double mass = 0.0; ///< [kg]; 0 of a body that is not dynamic: nothing moves it
    Vec3 centre = {};  ///< [m] of mass, in the element's coordinates; their origin where it has no mass
    Mat3 inertia = {}; ///< [kg m^2] about the centre, along the element's axes
};
/// As the Def has it or its mesh and density say. Throws an Error naming the body, also for a mesh that is not closed.
RigidInertia inertiaOf(const RigidBodyDef& def);

/// The same of every link of an articulated body, the base included: of the joint that moves it, or as the body says.
/// Zeros where nothing tells it: such a link goes where joints take it, and cannot be pushed.
std::vector<RigidInertia> linkInertias(const RigidBodyDef& def);

/// Can a force command a joint: is there something that resists.
bool takesForce(const JointDef& joint, const RigidInertia& child);

} // namespace filasofia::physics
