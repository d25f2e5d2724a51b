#include "filasofia/physics/defs.h"

#include "filasofia/core/check_name.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/mesh_pieces.h"
#include "filasofia/math/world_inertia.h"
#include "filasofia/physics/articulation.h"
#include "filasofia/physics/check_field.h"
#include "filasofia/physics/check_line.h"
#include "filasofia/physics/check_shell.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::physics {
namespace {

void load(TriangleMeshSource& source, std::string_view object)
{
    if (auto mesh = loadMesh(source, object)) source = std::move(mesh);
}

void load(std::vector<CollisionDef>& collision, const std::string& object)
{
    for (std::size_t i = 0; i < collision.size(); ++i)
        load(collision[i].mesh, text(object, ": collision[", i, "].mesh"));
}

std::string_view kindOf(const BodyDef& def)
{
    if (std::holds_alternative<SoftBodyDef>(def)) return "soft body";
    return std::holds_alternative<RodBodyDef>(def) ? "rod" : "rigid body";
}

/// Cuts need a surface that is a manifold. Parts that touch in an edge or a node, an accident of meshers, carry no
/// moment.
std::shared_ptr<const geometry::TetMesh> apart(std::shared_ptr<const geometry::TetMesh> mesh, std::string_view object)
{
    auto split = std::make_shared<geometry::TetMesh>(geometry::withSplitNodes(*mesh));
    const std::size_t copies = split->nodes.size() - mesh->nodes.size();
    if (copies == 0) return mesh;
    logWarning(
        object, ": ", copies, copies == 1 ? " node was" : " nodes were",
        " added where parts of the mesh touch in an edge or a node only: they come apart there, so that the body "
        "can be cut (dynamicTopology)");
    return split;
}

/// Faster than this, a state counts as a blow-up.
void checkVelocity(Vec3 v, const std::string& field)
{
    if (!(length(v) < kFarthest)) fail(field, " must have a length < ", kFarthest, ", got ", v.x, " ", v.y, " ", v.z);
}

/// Lighter bodies hardly fall. What is not positive is refused as such.
void checkDensity(double density, const std::string& field)
{
    if (density > 0.0 && density < kLeastDensity)
        fail(field, " must be >= ", kLeastDensity, " kg/m^3, which the arithmetic bears, got ", density);
}

} // namespace

void check(const GivenInertia& given, const std::string& object)
{
    const Vec3 m = given.moments;
    if (!(std::min({m.x, m.y, m.z}) > 0.0)) fail(object, ".moments must be > 0 kg m^2, got ", m.x, " ", m.y, " ", m.z);
    const double largest = std::max({m.x, m.y, m.z});
    constexpr double rounding = 1e-9; // for the moments of a rod or a plate, which satisfy an equality
    if (largest > (1.0 + rounding) * (m.x + m.y + m.z - largest))
        fail(object, ".moments must each be at most the sum of the other two, got ", m.x, " ", m.y, " ", m.z);
    static_cast<void>(unitPose({{}, given.axes}, object + ".axes"));
}

namespace {

void checkTearing(double threshold, bool dynamicTopology, const std::string& object)
{
    if (threshold < kNever && !dynamicTopology)
        fail(object, ".tearingThreshold must be infinite without dynamicTopology, got ", threshold, " Pa");
}

template <class Mesh> bool holds(const SoftMeshSource& source)
{
    return std::holds_alternative<std::shared_ptr<const Mesh>>(source);
}

/// Whether mesh and material go together. Only a mesh that is named by a file cannot be of the wrong kind: the material
/// decides how it is read.
void checkKind(const SoftBodyDef& def, const std::string& object)
{
    if (isShell(def) && holds<geometry::TetMesh>(def.mesh))
        fail(object, ": mesh must be a triangle mesh for a ShellMaterial, got a tetrahedral mesh");
    if (!isShell(def) && holds<geometry::TriangleMesh>(def.mesh))
        fail(object,
             ": mesh must be a tetrahedral mesh for this material, got a triangle mesh, as a box or a sheet is; a "
             "block has tetrahedra, and only a ShellMaterial has triangles");
}

} // namespace

void checkPressure(const CavityDef& cavity, double pressure, const std::string& name)
{
    if (cavity.fill == CavityFill::Liquid && !(pressure > -cavity.bulkModulus))
        fail(name, " must be > -bulkModulus, ", -cavity.bulkModulus, " Pa, for a liquid, got ", pressure);
}

namespace {

/// What fills cavities is part of the step's matrix, which only the default solver can do.
void checkCavities(const SoftBodyDef& def, const std::string& object)
{
    if (def.cavities.empty()) return;
    if (!std::holds_alternative<ImplicitEuler>(def.integrator))
        fail(object, ": cavities need integrator ImplicitEuler, got ExplicitEuler");
    const auto* cg = std::get_if<ConjugateGradient>(&def.solver);
    if (!cg || cg->assembled)
        fail(object, ": cavities need the default solver, got ", cg ? "an assembled ConjugateGradient" : "Cholesky");
    for (std::size_t c = 0; c < def.cavities.size(); ++c)
        checkPressure(def.cavities[c], def.cavities[c].pressure, text(object, ": cavities[", c, "].pressure"));
}

constexpr const char* kTouchesNothing = "a needle that touches nothing pierces nothing";

void check(const PunctureDef& def, const SoftBodyDef& body, const std::string& object)
{
    if (isShell(body)) fail(object, ": puncture must be none with a ShellMaterial: needles pierce tetrahedra only");
    if (body.collision.empty()) fail(object, ": collision must have an entry if puncture is given: ", kTouchesNothing);
    if (std::ranges::all_of(body.collision, [](const CollisionDef& each) { return each.cutting; }))
        fail(object,
             ": collision must have an entry without cutting if puncture is given: only blades meet one that "
             "has it, and ",
             kTouchesNothing);
    if (!def.stiffness && !std::holds_alternative<FemMaterial>(body.material))
        fail(object, ": puncture.stiffness must be given with a MassSpringMaterial, which has no Young's modulus");
    if (def.staticFriction && *def.staticFriction < def.friction)
        fail(object, ": puncture.staticFriction must be >= friction, ", def.friction, " N/m, got ",
             *def.staticFriction);
}

void check(const NeedleDef& def, std::size_t elements, const std::string& body)
{
    const std::string object = body + ": needle";
    constexpr double kMostPoints = 500;
    checkElement(def.element, elements, object + ".element");
    if (def.line.size() < 2) fail(object, ".line must have at least 2 points, got ", def.line.size());
    checkLine(def.line, false, body, "needle.line");
    double whole = 0.0;
    for (std::size_t i = 0; i + 1 < def.line.size(); ++i) whole += length(def.line[i + 1] - def.line[i]);
    if (!(whole < kFarthest)) fail(object, ".line must be shorter than ", kFarthest, " m, got ", whole);
    if (!(whole <= kMostPoints * def.spacing))
        fail(object, ".spacing must leave at most ", kMostPoints, " points, got ", def.spacing, " m on ", whole, " m");
    if (!(def.spacing < whole)) fail(object, ".spacing must be < the line's length, ", whole, " m, got ", def.spacing);
}

void check(const SoftBodyDef& def)
{
    const std::string object = text("soft body '", def.name, "'");
    checkKind(def, object);
    checkVelocity(def.velocity, object + ": velocity");
    if (const auto* density = std::get_if<Density>(&def.mass)) checkDensity(density->value, object + ": mass.value");
    if (def.puncture) check(*def.puncture, def, object);
    checkCavities(def, object);
    for (std::size_t i = 0; i < def.collision.size(); ++i)
        if (def.collision[i].element != 0)
            fail(object, ": collision[", i, "].element must be 0 for a soft body, got ", def.collision[i].element);
    for (std::size_t i = 0; isShell(def) && i < def.collision.size(); ++i)
        if (isGiven(def.collision[i].mesh))
            fail(object, ": collision[", i, "].mesh must be empty with a ShellMaterial: its own triangles collide");
    if (const auto* springs = std::get_if<MassSpringMaterial>(&def.material))
        checkTearing(springs->tearingThreshold, def.dynamicTopology, object + ": material");
    if (const auto* shell = std::get_if<ShellMaterial>(&def.material))
        checkTearing(shell->tearingThreshold, def.dynamicTopology, object + ": material");
    const auto* fem = std::get_if<FemMaterial>(&def.material);
    if (!fem) return;
    checkTearing(fem->tearingThreshold, def.dynamicTopology, object + ": material");
    check(*fem, object + ": material");
    for (std::size_t i = 0; i < fem->regions.size(); ++i) {
        const TissueRegion& region = fem->regions[i];
        const std::string name = text(object, ": material.regions[", i, "]");
        checkTearing(region.tearingThreshold.value_or(kNever), def.dynamicTopology, name);
        if (region.density) checkDensity(*region.density, name + ".density");
        if (region.density && !std::holds_alternative<Density>(def.mass))
            fail(name, ".density needs a mass of the body that is a Density, got a TotalMass");
    }
}

void check(const RigidBodyDef& def)
{
    const std::string object = text("rigid body '", def.name, "'");
    validate(def, object);
    if (def.elements.empty()) fail(object, ": elements must have at least one entry, got none");
    if (isArticulated(def)) checkArticulation(def, object);
    if (const auto* given = std::get_if<GivenInertia>(&def.mass))
        check(*given, object + ": mass");
    else if (def.dynamic && !isGiven(def.mesh))
        fail(object,
             ": mass of a dynamic body without a mesh must be GivenInertia; density and total mass need a mesh");
    for (const auto& [field, v] : {std::pair{"velocity", def.velocity}, {"angularVelocity", def.angularVelocity}})
        checkVelocity(v, text(object, ": ", field));
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const std::string field = text(object, ": collision[", i, "]");
        checkElement(def.collision[i].element, elementCount(def), field + ".element");
        if (def.collision[i].self && elementCount(def) == 1)
            fail(field, ".self must be false for a rigid body of one element, which cannot collide with itself");
        if (!isGiven(def.collision[i].mesh) && !isGiven(def.mesh))
            fail(field, ".mesh must name a file or be a mesh, because the body has no mesh of its own; got nothing");
    }
    for (std::size_t i = 0; i < def.attachments.size(); ++i)
        checkElement(def.attachments[i].element, elementCount(def), text(object, ": attachments[", i, "].element"));
    if (!def.needle) return;
    check(*def.needle, elementCount(def), object);
    if (std::ranges::none_of(def.collision,
                             [&](const CollisionDef& each) { return each.element == def.needle->element; }))
        fail(object, ": collision must have an entry of element ", def.needle->element,
             ", which has the needle: ", kTouchesNothing);
}

void check(const RodBodyDef& def)
{
    const std::string object = text("rod '", def.name, "'");
    validate(def, object);
    checkDensity(def.density, object + ": density");
    checkVelocity(def.velocity, object + ": velocity");
    if (def.breakForce < kNever && !def.dynamicTopology)
        fail(object, ": breakForce must be infinite without dynamicTopology, got ", def.breakForce, " N");
    if (def.hardening > 0.0 && !std::isfinite(def.yieldStrain))
        fail(object, ": hardening must be 0 without a yieldStrain, got ", def.hardening);
    if (def.needle && def.closed) fail(object, ": needle must be false if closed: a ring has no tip");
    if (def.needle && !def.collision) fail(object, ": collision must be given if needle is true: ", kTouchesNothing);
    static_cast<void>(centreLine(def));
}

} // namespace

bool hasSurface(const BodyDef& def)
{
    const auto* rigid = std::get_if<RigidBodyDef>(&def);
    const auto* file = rigid ? std::get_if<std::string>(&rigid->mesh) : nullptr;
    return !file || !file->empty();
}

std::string describeBody(const BodyDef& def)
{
    return std::visit([&](const auto& each) { return text(kindOf(def), " '", each.name, "'"); }, def);
}

Pose unitPose(const Pose& pose, std::string_view object)
{
    const Quat q = pose.orientation;
    const double size = std::sqrt(dot(q, q));
    if (!(size > 1e-6)) fail(object, ": orientation must have a length > 1e-06, got ", size);
    const Vec3 p = pose.position;
    if (!(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest))
        fail(object, ": position must lie within ", kFarthest, " m of the origin, got ", p.x, " ", p.y, " ", p.z);
    constexpr double kUnit =
        1e-15; // a product of unit quaternions may be this far from unit length by rounding: it is left as it is
    return {p, std::abs(size - 1.0) < kUnit ? q : normalized(q)};
}

bool isShell(const SoftBodyDef& def) { return std::holds_alternative<ShellMaterial>(def.material); }

namespace {

/// The mesh of a Def, unless it is of another kind. `read` reads a file.
template <class Mesh, class Read> std::shared_ptr<const Mesh> meshOf(const SoftBodyDef& def, const Read& read)
{
    const std::string object = text("soft body '", def.name, "'");
    checkKind(def, object);
    if (const auto* file = std::get_if<std::string>(&def.mesh)) {
        if (file->empty()) fail(object, ": mesh must name a file or be a mesh, got nothing");
        try {
            return std::make_shared<const Mesh>(read(*file));
        } catch (const Error& error) { // the material decides how a file is read
            fail(object,
                 isShell(def) ? ": mesh must have triangles, for its ShellMaterial: " : ": mesh: ", error.what());
        }
    }
    const auto& given = std::get<std::shared_ptr<const Mesh>>(def.mesh);
    if (!given) fail(object, ": mesh must name a file or be a mesh, got nothing");
    geometry::check(*given, object + ": mesh");
    return given;
}

void place(const SoftBodyDef& def, std::vector<Vec3>& nodes)
{
    const Pose pose = unitPose(def.pose, text("soft body '", def.name, "': pose"));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Vec3 p = nodes[i] = transform(pose, nodes[i]);
        if (!(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest))
            fail("soft body '", def.name, "': mesh: node ", i, " must lie within ", kFarthest, " m of the origin, got ",
                 p.x, " ", p.y, " ", p.z);
    }
}

} // namespace

std::shared_ptr<const geometry::TetMesh> loadMesh(const SoftBodyDef& def)
{
    if (isShell(def)) fail("soft body '", def.name, "': mesh must be tetrahedral here, but the body is a shell");
    return meshOf<geometry::TetMesh>(def, [](const std::string& file) { return geometry::loadTetMesh(file); });
}

geometry::TetMesh worldMesh(const SoftBodyDef& def)
{
    geometry::TetMesh mesh = *loadMesh(def);
    place(def, mesh.nodes);
    return mesh;
}

std::shared_ptr<const geometry::TriangleMesh> loadShell(const SoftBodyDef& def)
{
    if (!isShell(def)) fail("soft body '", def.name, "': material must be a ShellMaterial to have triangles");
    auto mesh =
        meshOf<geometry::TriangleMesh>(def, [](const std::string& file) { return geometry::loadTriangleMesh(file); });
    const bool bends = std::get<ShellMaterial>(def.material).bendingScale > 0.0;
    checkShell(*mesh, bends, text("soft body '", def.name, "': mesh"));
    return mesh;
}

geometry::TriangleMesh worldShell(const SoftBodyDef& def)
{
    geometry::TriangleMesh mesh = *loadShell(def);
    place(def, mesh.vertices);
    return mesh;
}

std::shared_ptr<const geometry::TriangleMesh> loadMesh(const TriangleMeshSource& source, std::string_view object)
{
    if (!isGiven(source)) return nullptr;
    if (const auto* file = std::get_if<std::string>(&source))
        return std::make_shared<const geometry::TriangleMesh>(geometry::loadTriangleMesh(*file));
    const auto& given = std::get<std::shared_ptr<const geometry::TriangleMesh>>(source);
    if (!given) fail(object, " must name a file or be a mesh, got a null pointer");
    geometry::check(*given, object);
    return given;
}

SoftBodyDef loaded(SoftBodyDef def)
{
    if (isShell(def)) {
        def.mesh = loadShell(def);
        load(def.collision, text("soft body '", def.name, "'"));
        return def;
    }
    std::shared_ptr<const geometry::TetMesh> mesh = loadMesh(def);
    if (def.dynamicTopology) mesh = apart(std::move(mesh), text("soft body '", def.name, "'"));
    def.mesh = mesh;
    if (auto* fem = std::get_if<FemMaterial>(&def.material))
        resolveNames(*mesh, text("soft body '", def.name, "': material"), *fem);
    load(def.collision, text("soft body '", def.name, "'"));
    return def;
}

RigidBodyDef loaded(RigidBodyDef def)
{
    const std::string object = text("rigid body '", def.name, "'");
    load(def.mesh, object + ": mesh");
    load(def.collision, object);
    return def;
}

void check(const BodyDef& def)
{
    checkName(std::visit([](const auto& each) -> std::string_view { return each.name; }, def), kindOf(def));
    std::visit([](const auto& each) { check(each); }, def);
}

RigidInertia inertiaOf(const GivenInertia& given)
{
    return {given.mass, given.centre, worldInertia(Mat3::diagonal(given.moments), normalized(given.axes))};
}

RigidInertia inertiaOf(const RigidBodyDef& def)
{
    check(def);
    if (!def.dynamic) return {};
    if (const auto* given = std::get_if<GivenInertia>(&def.mass)) return inertiaOf(*given);
    const std::string object = text("rigid body '", def.name, "': mesh");
    const geometry::MassProperties body = geometry::massProperties(*loadMesh(def.mesh, object), object);
    const auto* density = std::get_if<Density>(&def.mass);
    const double perVolume = density ? density->value : std::get<TotalMass>(def.mass).value / body.volume;
    return {perVolume * body.volume, body.centre, perVolume * body.inertia};
}

} // namespace filasofia::physics
