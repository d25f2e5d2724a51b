#include "filasofia/sofa/soft_plan.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/rupture/cuttable.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/sofa/lacks.h"
#include "filasofia/sofa/make_tie.h"

#include <algorithm>
#include <cmath>

namespace filasofia::sofaengine {
namespace {

using physics::FemMaterial;
using physics::SoftBodyDef;
using physics::TissueRegion;

/// SOFA's laws of the same energy as ours.
bool isKnown(const physics::ElasticLaw& law)
{
    return std::holds_alternative<physics::Corotational>(law) || std::holds_alternative<physics::NeoHookean>(law) ||
           std::holds_alternative<physics::StVenantKirchhoff>(law);
}

bool isUniform(const FemMaterial& material)
{
    const auto elastic = [](const TissueRegion& each) { return each.youngModulus || each.poissonRatio; };
    return material.stiffnessField.empty() && std::ranges::none_of(material.regions, elastic);
}

void checkMaterial(const FemMaterial& material, const std::string& object)
{
    if (!isKnown(material.law)) fail(object, ".law ", nameOf(material.law), kLacks);
    if (!material.fibres.empty()) fail(object, ".fibres", kLacks);
    if (!material.relaxation.empty()) fail(object, ".relaxation", kLacks);
    if (std::isfinite(material.yieldStress)) fail(object, ".yieldStress", kLacks);
    for (std::size_t i = 0; i < material.regions.size(); ++i) {
        const TissueRegion& region = material.regions[i];
        const char* field = region.restScale ? "restScale" : region.yieldStress ? "yieldStress" : nullptr;
        if (field) fail(object, ".regions[", i, "].", field, kLacks);
    }
    if (!std::holds_alternative<physics::Corotational>(material.law) && !isUniform(material))
        fail(object, ": a ", nameOf(material.law), " law whose stiffness differs between elements", kLacks,
             ": use Corotational");
}

void checkBody(const SoftBodyDef& def, const std::string& object)
{
    if (std::holds_alternative<physics::ShellMaterial>(def.material)) fail(object, ": material: a shell", kLacks);
    if (def.puncture) fail(object, ": puncture", kLacks);
    if (!def.cavities.empty()) fail(object, ": cavities", kLacks);
    if (!(def.velocity == Vec3{})) fail(object, ": velocity", kLacks);
}

double densityOf(const SoftBodyDef& def, const geometry::TetMesh& mesh)
{
    if (const auto* density = std::get_if<physics::Density>(&def.mass)) return density->value;
    double volume = 0.0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) volume += signedVolume(mesh, static_cast<int>(t));
    return std::get<physics::TotalMass>(def.mass).value / volume;
}

/// Stiffness per tetrahedron, with what regions say, their strengths and densities: the last of several regions counts.
void addTissue(const FemMaterial& material, const std::string& object, SoftPlan& plan)
{
    physics::check(material, plan.mesh, object);
    checkMaterial(material, object);
    plan.youngModulus.assign(plan.density.size(), material.youngModulus);
    plan.poissonRatio.assign(plan.density.size(), material.poissonRatio);
    plan.tearing.assign(plan.density.size(), material.tearingThreshold);
    const geometry::TetMesh atRest = *loadMesh(plan.def); // regions are in the coordinates of the mesh
    for (std::size_t i = 0; i < material.regions.size(); ++i) {
        const TissueRegion& region = material.regions[i];
        for (const int t : tetrahedraOf(region.where, atRest, text(object, ".regions[", i, "].where"))) {
            const auto at = static_cast<std::size_t>(t);
            plan.youngModulus[at] = region.youngModulus.value_or(plan.youngModulus[at]);
            plan.poissonRatio[at] = region.poissonRatio.value_or(plan.poissonRatio[at]);
            plan.tearing[at] = region.tearingThreshold.value_or(plan.tearing[at]);
            plan.density[at] = region.density.value_or(plan.density[at]);
        }
    }
    for (std::size_t t = 0; t < material.stiffnessField.size(); ++t) plan.youngModulus[t] *= material.stiffnessField[t];
}

void addSprings(SoftPlan& plan)
{
    plan.edges.clear();
    for (const geometry::Tetrahedron& t : plan.mesh.tetrahedra)
        for (int i = 0; i < 4; ++i)
            for (int j = i + 1; j < 4; ++j) plan.edges.push_back({std::min(t[i], t[j]), std::max(t[i], t[j])});
    std::ranges::sort(plan.edges);
    plan.edges.erase(std::ranges::unique(plan.edges).begin(), plan.edges.end());
}

/// What the mesh is made of.
void addMaterial(const std::string& object, SoftPlan& plan)
{
    plan.density.assign(plan.mesh.tetrahedra.size(), densityOf(plan.def, plan.mesh));
    if (const auto* tissue = std::get_if<FemMaterial>(&plan.def.material))
        addTissue(*tissue, object, plan);
    else
        plan.tearing.assign(plan.density.size(),
                            std::get<physics::MassSpringMaterial>(plan.def.material).tearingThreshold);
    if (std::ranges::none_of(plan.tearing, [](double each) { return std::isfinite(each); })) plan.tearing.clear();
}

PinGroup pinsOf(const physics::AttachmentDef& def, const std::string& object, const std::vector<Vec3>& rest)
{
    const int count = static_cast<int>(rest.size());
    for (const int node : def.nodes)
        if (node < 0 || node >= count) fail(object, ".nodes must be in [0, ", count, "), got ", node);
    if (def.box && geometry::isEmpty(*def.box)) fail(object, ".box: high must be >= low in every axis");
    PinGroup group{.nodes = nodesOf(def, rest), .stiffness = def.stiffness};
    if (group.nodes.empty() && !isTie(def)) fail(object, ": must hold at least one node, got none");
    for (const int node : group.nodes) group.places.push_back(rest[static_cast<std::size_t>(node)]);
    return group;
}

} // namespace

std::vector<int> nodesOf(const physics::AttachmentDef& def, const std::vector<Vec3>& at)
{
    std::vector<int> nodes = def.nodes;
    for (std::size_t i = 0; i < at.size(); ++i) {
        const bool inBall = def.ball && distance(at[i], def.ball->centre) <= def.ball->radius;
        if (inBall || (def.box && geometry::squaredDistance(*def.box, at[i]) == 0.0))
            nodes.push_back(static_cast<int>(i));
    }
    std::ranges::sort(nodes);
    nodes.erase(std::ranges::unique(nodes).begin(), nodes.end());
    return nodes;
}

/// A quarter of each tetrahedron's mass is at each of its corners.
void shapePlan(SoftPlan& plan)
{
    if (std::holds_alternative<physics::MassSpringMaterial>(plan.def.material)) addSprings(plan);
    plan.masses.assign(plan.mesh.nodes.size(), 0.0);
    geometry::TetMesh left{plan.mesh.nodes, {}};
    for (std::size_t t = 0; t < plan.density.size(); ++t) {
        for (const int node : plan.mesh.tetrahedra[t])
            plan.masses[static_cast<std::size_t>(node)] +=
                plan.density[t] * signedVolume(plan.mesh, static_cast<int>(t)) / 4.0;
        if (plan.gone.empty() || plan.gone[t] == 0) left.tetrahedra.push_back(plan.mesh.tetrahedra[t]);
    }
    const geometry::Surface surface = geometry::extractSurface(left);
    plan.surface.clear();
    for (const geometry::Triangle& each : surface.mesh.triangles) {
        const auto node = [&](int corner) { return surface.nodes[static_cast<std::size_t>(each[corner])]; };
        plan.surface.push_back({node(0), node(1), node(2)});
    }
    for (CollisionPlan& each : plan.collision) {
        if (each.nodes.empty()) continue;
        each.mesh = surface.mesh;
        each.nodes = surface.nodes;
    }
}

std::vector<std::uint8_t> heldNodes(const std::vector<PinGroup>& pins, std::size_t nodes)
{
    std::vector<std::uint8_t> held(nodes);
    for (const PinGroup& group : pins)
        if (group.stiffness == physics::kHard)
            for (const int node : group.nodes) held[static_cast<std::size_t>(node)] = 1;
    return held;
}

void eraseNodes(const std::function<bool(int)>& isGone, std::vector<PinGroup>& pins)
{
    for (PinGroup& group : pins)
        for (std::size_t i = group.nodes.size(); i-- > 0;) {
            if (!isGone(group.nodes[i])) continue;
            group.nodes.erase(group.nodes.begin() + static_cast<std::ptrdiff_t>(i));
            group.places.erase(group.places.begin() + static_cast<std::ptrdiff_t>(i));
        }
}

bool mayBeCut(const SoftBodyDef& def, int group)
{
    const auto tagOf = [](const physics::CollisionDef& each) { return engine::BladeTag{each.group, each.cutting}; };
    return def.dynamicTopology && engine::mayBeCutBy(group, def.collision, tagOf);
}

SoftPlan planSoft(const SoftBodyDef& def)
{
    const std::string object = describeBody(physics::BodyDef{def});
    validate(def, object);
    check(physics::BodyDef{def});
    checkBody(def, object);
    SoftPlan plan{.def = def, .mesh = worldMesh(def)};
    addMaterial(object + ": material", plan);
    plan.collision = planCollision(def, plan.mesh, object);
    shapePlan(plan);
    if (def.dynamicTopology) engine::checkForCuts(object, engine::EditableMesh(plan.mesh));
    for (std::size_t i = 0; i < def.attachments.size(); ++i) {
        const std::string field = text(object, ": attachments[", i, "]");
        PinGroup pins = pinsOf(def.attachments[i], field, plan.mesh.nodes);
        pins.id = {static_cast<std::uint32_t>(i)};
        if (!isTie(def.attachments[i])) plan.pins.push_back(std::move(pins));
    }
    for (const physics::NodalForce& each : def.forces)
        if (static_cast<std::size_t>(each.node) >= plan.mesh.nodes.size())
            fail(object, ": forces: node must be in [0, ", plan.mesh.nodes.size(), "), got ", each.node);
    return plan;
}

} // namespace filasofia::sofaengine
