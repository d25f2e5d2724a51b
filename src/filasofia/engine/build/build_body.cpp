#include "filasofia/engine/build/build_body.h"

#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/build/build_rigid.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/topology/loose_pieces.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/space_order.h"
#include "filasofia/geometry/surface.h"

#include <algorithm>
#include <numbers>

namespace filasofia::engine {
namespace {

using geometry::TetMesh;

void addElements(const TetMesh& mesh, SoftModel& model)
{
    std::vector<Vec3> centres;
    for (const geometry::Tetrahedron& t : mesh.tetrahedra)
        centres.push_back(0.25 * (mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]] + mesh.nodes[t[3]]));
    for (int each : geometry::orderAlongCurve(centres)) {
        FemElement& element = model.elements.emplace_back();
        element.tetrahedron = each;
        element.nodes = mesh.tetrahedra[each];
        shapeElement(mesh.nodes, element);
    }
}

/// [kg/m^3] that a mass has on average in a volume [m^3]. Throws an Error if it is so low that nothing would fall.
double densityIn(double volume, const physics::Mass& mass, const std::string& object)
{
    if (const auto* density = std::get_if<physics::Density>(&mass)) return density->value; // the Def was checked
    const double total = std::get<physics::TotalMass>(mass).value;
    if (!(total / volume >= physics::kLeastDensity))
        fail(object, ": mass.value must be >= ", physics::kLeastDensity * volume, " kg, ", physics::kLeastDensity,
             " kg/m^3 in its ", volume, " m^3, got ", total);
    return total / volume;
}

double volumeOf(const TetMesh& mesh)
{
    double volume = 0.0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        volume += geometry::signedVolume(mesh, static_cast<int>(t));
    return volume;
}

/// Gives nodes their masses and elements their densities.
void addMasses(const TetMesh& mesh, SoftModel& model)
{
    std::vector<double> relative(mesh.tetrahedra.size(), 1.0); // densities, to that of the body
    for (std::size_t t = 0; model.tissue && t < relative.size(); ++t)
        relative[t] = model.tissue->of[t].density / model.density;
    for (FemElement& element : model.elements)
        element.density = model.tissue->of[static_cast<std::size_t>(element.tetrahedron)].density;
    model.masses.assign(mesh.nodes.size(), 0.0);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (int node : mesh.tetrahedra[t])
            model.masses[node] += relative[t] * geometry::signedVolume(mesh, static_cast<int>(t)) / 4.0;
    for (double& each : model.masses) each *= model.density;
}

/// Turns an attachment to space that cannot break into pins, which are exact and cheap. If the attachment is to another
/// body, or may break, it is created after the body has been added.
void addPins(const physics::AttachmentDef& def, const std::string& object, SoftModel& model)
{
    const int count = static_cast<int>(model.rest.size());
    for (int node : def.nodes)
        if (node < 0 || node >= count) fail(object, ".nodes must be in [0, ", count, "), got ", node);
    if (def.box && geometry::isEmpty(*def.box)) fail(object, ".box: high must be >= low in every axis");
    if (def.to) return;
    if (def.within) fail(object, ".within needs a body `to`: it is the distance from its surface");
    const std::vector<int> nodes = nodesOf(def, model.rest);
    if (nodes.empty())
        fail(object, ": must hold at least one node, got none",
             def.box    ? " in its box"
             : def.ball ? " in its ball"
                        : "");
    if (!isPins(def)) return;
    model.pins.groups.push_back({.id = {}, .nodes = nodes, .stiffness = def.stiffness});
    for (int node : nodes) {
        if (def.stiffness == physics::kHard)
            model.pins.hard[node] = true;
        else
            model.pins.springs.push_back({node, model.rest[node], def.stiffness});
    }
}

PunctureModel punctureOf(const physics::SoftBodyDef& def)
{
    const physics::PunctureDef& from = *def.puncture;
    return {.force = from.force,
            .cutting = from.cutting,
            .friction = from.friction,
            .staticFriction = from.staticFriction.value_or(from.friction),
            .stiffness = from.stiffness.value_or(0.0), // setMaterial() knows that of a material
            .ofMaterial = !from.stiffness};
}

/// Everything of a body of tetrahedra that depends on its mesh and material.
void makeSolid(const physics::SoftBodyDef& def, const std::string& object, SoftModel& model)
{
    const TetMesh mesh = physics::worldMesh(def);
    if (!usable(mesh.nodes)) fail(object, ": nodes must lie within ", physics::kFarthest, " m of the origin");
    model.rest = mesh.nodes;
    model.collision = buildCollision(def, mesh);
    model.density = densityIn(volumeOf(mesh), def.mass, object); // where no region says another
    if (std::holds_alternative<physics::FemMaterial>(def.material)) {
        model.mesh = physics::loadMesh(def);
        model.orientation = physics::unitPose(def.pose, object).orientation;
        addElements(mesh, model);
    } else {
        model.tetrahedra = mesh.tetrahedra;
        for (const std::array<int, 2>& edge : geometry::edges(mesh))
            model.springs.push_back(springOn(edge, {}, model.rest));
    }
    setMaterial(def.material, mapTissue(def.material, model), model);
    addMasses(mesh, model);
    const geometry::Surface surface = geometry::extractSurface(mesh);
    for (const geometry::Triangle& t : surface.mesh.triangles)
        model.surface.push_back({surface.nodes[t[0]], surface.nodes[t[1]], surface.nodes[t[2]]});
}

/// The same of a shell.
void makeSheet(const physics::SoftBodyDef& def, const std::string& object, SoftModel& model)
{
    const geometry::TriangleMesh mesh = physics::worldShell(def);
    if (!usable(mesh.vertices)) fail(object, ": nodes must lie within ", physics::kFarthest, " m of the origin");
    model.rest = mesh.vertices;
    model.surface = mesh.triangles;
    model.collision = buildCollision(def, mesh);
    setMaterial(def.material, nullptr, model);

    double area = 0.0;
    for (const MembraneElement& each : model.shell.membranes) area += each.area;
    const double thickness = model.shell.material.thickness;
    model.density = densityIn(area * thickness, def.mass, object);
    model.masses.assign(mesh.vertices.size(), 0.0);
    for (const MembraneElement& each : model.shell.membranes)
        for (int node : each.nodes) model.masses[node] += model.density * thickness * each.area / 3.0;
}

/// The pins of a body, and the forces on it at the start. From then on nothing of it may be wrong.
template <class Def> void finish(const Def& def, const std::string& object, SoftBody& body)
{
    SoftModel& model = body.model;
    const int nodes = static_cast<int>(model.rest.size());
    model.pins.hard.assign(model.rest.size(), false);
    for (std::size_t a = 0; a < def.attachments.size(); ++a)
        addPins(def.attachments[a], text(object, ": attachments[", a, "]"), model);
    for (std::size_t i = 0; i < def.forces.size(); ++i)
        if (const int node = def.forces[i].node; node >= nodes)
            fail(object, ": forces[", i, "].node must be in [0, ", nodes, "), got ", node);
    model.startVelocity = def.velocity;
    body.state = stateAtStart(model);
    setForces(def.forces, body.state);
}

std::unique_ptr<physics::BuiltBody> buildRod(const physics::RodBodyDef& def, double period)
{
    const std::string object = text("rod '", def.name, "'");
    auto built = std::make_unique<BuiltSoftBody>();
    SoftModel& model = built->body.model;
    model.name = def.name;
    model.rayleigh = def.rayleigh;
    model.solver = physics::Cholesky{};
    model.gravity = def.gravity;
    model.friction = def.friction;
    model.density = def.density;
    model.dynamicTopology = def.dynamicTopology;
    model.rest = physics::centreLine(def);
    model.rod = makeRod(def, model.rest);
    model.masses.assign(model.rest.size(), 0.0);
    const double perLength = def.density * std::numbers::pi * def.radius * def.radius;
    for (const Spring& edge : model.rod.edges)
        for (int node : edge.nodes) model.masses[static_cast<std::size_t>(node)] += 0.5 * perLength * edge.restLength;
    model.collision = buildCollision(def, model.rest);
    finish(def, object, built->body);
    check(model, built->body.state);
    built->body.topology = makeTopology(model);
    built->body.system = makeSystem(model, period);
    return built;
}

std::unique_ptr<physics::BuiltBody> buildSoft(const physics::SoftBodyDef& def, double period)
{
    const std::string object = text("soft body '", def.name, "'");
    validate(def, object);
    auto built = std::make_unique<BuiltSoftBody>();
    SoftModel& model = built->body.model;
    model.name = def.name;
    model.rayleigh = def.rayleigh;
    model.integrator = def.integrator;
    model.solver = def.solver;
    model.gravity = def.gravity;
    model.friction = def.friction;
    model.dynamicTopology = def.dynamicTopology;
    if (def.puncture) model.puncture = punctureOf(def);
    physics::isShell(def) ? makeSheet(def, object, model) : makeSolid(def, object, model);
    addCavities(def.cavities, object, model);
    finish(def, object, built->body);
    built->body.state.pressure = def.pressure;
    check(model, built->body.state);
    built->body.topology = makeTopology(model);
    if (model.dynamicTopology) model.pieces = findPieces(model, *built->body.topology.pieces);
    built->body.system = makeSystem(model, period);
    warnOfStiffness(model, period);
    if (model.dynamicTopology) checkForCuts(object, *built->body.topology.mesh);
    return built;
}

} // namespace

std::unique_ptr<physics::BuiltBody> buildBody(const physics::BodyDef& def, double period)
{
    physics::check(def);
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&def)) return buildSoft(*soft, period);
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&def)) return buildRod(*rod, period);
    return buildRigid(std::get<physics::RigidBodyDef>(def));
}

} // namespace filasofia::engine
