#include "filasofia/engine/body/soft_model.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/body/check_collision.h"
#include "filasofia/engine/body/check_size.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/engine/rupture/cuttable.h"
#include "filasofia/physics/check_clip.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace filasofia::engine {
namespace {

void checkFinite(const std::string& object, const char* list, const std::vector<Vec3>& values)
{
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!isFinite(values[i])) fail(object, ": ", list, "[", i, "] must be finite");
}

template <class Nodes> void checkNodes(const std::string& object, const Nodes& nodes, std::size_t count)
{
    for (int node : nodes)
        if (node < 0 || static_cast<std::size_t>(node) >= count)
            fail(object, ": node must be in [0, ", count, "), got ", node);
}

void checkElements(const SoftModel& model, const std::string& object)
{
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        const std::string name = text(object, ": elements[", e, "]");
        checkNodes(name, element.nodes, model.rest.size());
        if (!positive().contains(element.volume)) fail(name, ".volume must be > 0 m^3, got ", element.volume);
        validate(physics::FemMaterial{.youngModulus = element.youngModulus, .poissonRatio = element.poissonRatio},
                 name);
        for (const Vec3& g : element.gradients)
            if (!isFinite(g)) fail(name, ".gradients must be finite");
    }
}

void checkSprings(const SoftModel& model, const std::string& object)
{
    for (std::size_t s = 0; s < model.springs.size(); ++s) {
        const Spring& spring = model.springs[s];
        const std::string name = text(object, ": springs[", s, "]");
        checkNodes(name, spring.nodes, model.rest.size());
        if (!nonNegative().contains(spring.restLength))
            fail(name, ".restLength must be >= 0 m, got ", spring.restLength);
        validate(physics::MassSpringMaterial{spring.stiffness, spring.damping}, name);
    }
}

void checkPins(const SoftModel& model, const std::string& object)
{
    checkSize(object, "pins.hard", model.pins.hard.size(), model.rest.size());
    for (const PinSpring& pin : model.pins.springs) {
        checkNodes(object, std::array{pin.node}, model.rest.size());
        if (!positive().contains(pin.stiffness))
            fail(object, ": a pin's stiffness must be > 0 N/m, got ", pin.stiffness);
        if (!isFinite(pin.anchor)) fail(object, ": a pin's anchor must be finite");
    }
    for (std::size_t g = 0; g < model.pins.groups.size(); ++g) {
        const PinGroup& group = model.pins.groups[g];
        const std::string name = text(object, ": pins.groups[", g, "]");
        checkNodes(name, group.nodes, model.rest.size());
        if (std::ranges::adjacent_find(group.nodes, std::ranges::greater_equal{}) != group.nodes.end())
            fail(name, ".nodes must ascend, each once");
        if (!positiveOrInfinite().contains(group.stiffness))
            fail(name, ".stiffness must be > 0 N/m, got ", group.stiffness);
    }
}

/// Writes what the map says of its tetrahedron into every element. The density stays: mass does not change.
void setTissue(SoftModel& model)
{
    model.tearingThreshold = model.material.tearingThreshold;
    model.yieldStress = model.material.yieldStress;
    for (FemElement& element : model.elements) {
        const TetrahedronTissue& tissue = model.tissue->of[static_cast<std::size_t>(element.tetrahedron)];
        element.youngModulus = tissue.youngModulus;
        element.poissonRatio = tissue.poissonRatio;
        element.tearingThreshold = tissue.tearingThreshold;
        element.yieldStress = tissue.yieldStress;
        model.tearingThreshold = std::min(model.tearingThreshold, element.tearingThreshold);
        model.yieldStress = std::min(model.yieldStress, element.yieldStress);
        const bool scaled = std::exchange(element.restScale, tissue.restScale) != tissue.restScale;
        const bool flowed = std::exchange(element.plastic, Mat3::identity()) != Mat3::identity();
        if (scaled || flowed) shapeElement(model.rest, element);
    }
    model.nodalVolumes = hasNodalVolumes(model.elements);
}

/// Gives every element the directions of its fibres.
void setFibres(SoftModel& model)
{
    model.fibres.clear();
    for (const std::vector<Vec3>& directions : model.tissue->fibres) {
        std::vector<Vec3>& of = model.fibres.emplace_back();
        for (const FemElement& element : model.elements)
            of.push_back(directions[static_cast<std::size_t>(element.tetrahedron)]);
    }
}

} // namespace

SoftState stateAtStart(const SoftModel& model)
{
    SoftState state;
    state.x = model.rest;
    state.v.assign(model.rest.size(), model.startVelocity);
    for (std::size_t i = 0; i < model.pins.hard.size(); ++i)
        if (model.pins.hard[i]) state.v[i] = {};
    state.dv.resize(model.rest.size());
    state.residual.resize(model.rest.size());
    state.forces.resize(model.rest.size());
    state.rotations.resize(static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(model.elements.size()))));
    restartRelaxation(model, state);
    state.rod = stateAtStart(model.rod);
    state.cavities = cavitiesAtRest(model);
    return state;
}

std::string describe(const SoftModel& model) { return text(isRod(model) ? "rod '" : "soft body '", model.name, "'"); }

bool mayBeCut(const SoftModel& model, int group)
{
    const auto tagOf = [](const CollisionModel& each) { return BladeTag{each.shape->group, each.shape->cutting}; };
    return model.dynamicTopology && mayBeCutBy(group, model.collision, tagOf);
}

namespace {

void checkCavities(const SoftModel& model, const SoftState& state, const std::string& object)
{
    if (!model.filling.empty()) checkSize(object, "filling", model.filling.size(), model.rest.size());
    checkSize(object, "cavities", state.cavities.size(), model.cavities.size());
    if (!model.cavities.empty()) checkSize(object, "wallOf", model.wallOf.size(), model.surface.size());
    for (std::size_t c = 0; c < model.cavities.size(); ++c) {
        const std::string name = text(object, ": cavities[", c, "]");
        const Cavity& cavity = model.cavities[c];
        validate(cavity.def, name);
        if (!positive().contains(cavity.restVolume)) fail(name, ".restVolume must be > 0 m^3, got ", cavity.restVolume);
        for (const geometry::Triangle& each : cavity.wall) checkNodes(name, each, model.rest.size());
        for (const CavityRim& rim : cavity.rims)
            for (const std::array<int, 2>& edge : rim.edges) checkNodes(name, edge, model.rest.size());
        const CavityState& now = state.cavities[c];
        for (double each : {now.content, now.pressure, now.inflow, now.conductance, now.last, now.lost})
            if (!std::isfinite(each)) fail(name, ": its state must be finite");
    }
}

void checkClips(const SoftModel& model, const SoftState& state, const std::string& object)
{
    for (const Clip& clip : state.clips) {
        const std::string name = text(object, ": clip ", clip.id.value);
        physics::check(clip.def, name);
        if (clip.pairs.empty()) fail(name, ": must have a pair of points");
        for (double each : {clip.gap, clip.age, clip.force})
            if (!std::isfinite(each)) fail(name, ": its state must be finite");
        for (const std::size_t each : clip.corners)
            if (each >= clip.pairs.size()) fail(name, ": corners must be pairs of it");
        for (const ClipPair& pair : clip.pairs)
            for (const auto& side : pair)
                for (const NodeWeight& each : side) {
                    checkNodes(name, std::array{each.node}, model.rest.size());
                    if (!std::isfinite(each.weight)) fail(name, ": weights must be finite, got ", each.weight);
                }
    }
}

} // namespace

void check(const SoftModel& model, const SoftState& state)
{
    const std::string object = describe(model);
    const std::size_t n = model.rest.size();
    if (n == 0) fail(object, ": must have at least one node");
    checkSize(object, "masses", model.masses.size(), n);
    for (double mass : model.masses)
        if (!positive().contains(mass)) fail(object, ": masses must be > 0 kg, got ", mass);
    validate(model.material, object + ": material");
    physics::check(model.material, object + ": material");
    checkElements(model, object);
    checkSprings(model, object);
    check(model.shell, n, object);
    check(model.rod, state.rod, n, object);
    if (isRod(model) && !std::holds_alternative<physics::ImplicitEuler>(model.integrator))
        fail(object, ": integrator must be ImplicitEuler for a rod");
    checkPins(model, object);
    checkCavities(model, state, object);
    checkClips(model, state, object);
    for (const geometry::Triangle& triangle : model.surface) checkNodes(object, triangle, n);
    for (const geometry::Tetrahedron& each : model.tetrahedra) checkNodes(text(object, ": tetrahedra"), each, n);
    if (!nonNegative().contains(model.friction)) fail(object, ": friction must be >= 0, got ", model.friction);
    checkCollision(object, model);
    validate(model.rayleigh, object + ": rayleigh");
    std::visit([&](const auto& each) { validate(each, object + ": integrator"); }, model.integrator);
    std::visit([&](const auto& each) { validate(each, object + ": solver"); }, model.solver);

    for (const auto& [list, values] : {std::pair{"x", &state.x},
                                       {"v", &state.v},
                                       {"dv", &state.dv},
                                       {"residual", &state.residual},
                                       {"forces", &state.forces},
                                       {"rest", &model.rest}}) {
        checkSize(object, list, values->size(), n);
        checkFinite(object, list, *values);
    }
    if (!usable(state.x) || !usable(state.v) || !usable(model.rest))
        fail(object, ": nodes must lie within ", physics::kFarthest,
             " m of the origin and be slower than that number in m/s");
    for (std::size_t i = 0; i < n; ++i)
        if (model.pins.hard[i] && !(state.v[i] == Vec3{} && state.dv[i] == Vec3{}))
            fail(object, ": v[", i, "] and dv[", i, "] must be 0 m/s: the node is pinned");
    const int blocks = linalg::blocksFor(static_cast<int>(model.elements.size()));
    checkSize(object, "rotations", state.rotations.size(), static_cast<std::size_t>(blocks));
    for (std::size_t e = 0; e < state.rotations.size() * kBlock; ++e)
        if (const Quat q = rotationOf(state.rotations, e); !(std::abs(dot(q, q) - 1.0) < 1e-5))
            fail(object, ": rotations must be unit quaternions");
    checkSize(object, "relaxation", state.relaxation.size(),
              model.material.relaxation.empty() ? 0 : static_cast<std::size_t>(blocks));
    if (!std::isfinite(state.pressure)) fail(object, ": pressure must be finite, got ", state.pressure);
}

Quat rotationOf(const std::vector<ElementRotations>& rotations, std::size_t element)
{
    const ElementRotations& block = rotations[element / kBlock];
    const std::size_t lane = element % kBlock;
    return {block.w[lane], block.x[lane], block.y[lane], block.z[lane]};
}

void setRotation(std::vector<ElementRotations>& rotations, std::size_t element, Quat q)
{
    ElementRotations& block = rotations[element / kBlock];
    const std::size_t lane = element % kBlock;
    block.w[lane] = static_cast<float>(q.w);
    block.x[lane] = static_cast<float>(q.x);
    block.y[lane] = static_cast<float>(q.y);
    block.z[lane] = static_cast<float>(q.z);
}

std::shared_ptr<const TissueMap> mapTissue(const physics::SoftMaterial& material, const SoftModel& model)
{
    const auto* fem = std::get_if<physics::FemMaterial>(&material);
    if (!fem) return nullptr;
    return mapTissue(*fem, *model.mesh, model.orientation, model.density,
                     text("soft body '", model.name, "': material"));
}

void setMaterial(const physics::SoftMaterial& material, const std::shared_ptr<const TissueMap>& map, SoftModel& model)
{
    model.patched = false;
    if (const auto* fem = std::get_if<physics::FemMaterial>(&material)) {
        model.material = *fem;
        model.tissue = map;
        constexpr double kStiffer = 10.0; // than the tissue: most of the compliance is left to it
        if (model.puncture && model.puncture->ofMaterial) model.puncture->stiffness = kStiffer * fem->youngModulus;
        setTissue(model);
        setFibres(model);
        return;
    }
    if (const auto* shell = std::get_if<physics::ShellMaterial>(&material)) {
        model.tearingThreshold = shell->tearingThreshold;
        // A shell that was cut keeps the order of its triangles.
        model.shell =
            isShell(model) ? makeShell(*shell, model.rest, model.shell) : makeShell(*shell, model.rest, model.surface);
        return;
    }
    const auto& springs = std::get<physics::MassSpringMaterial>(material);
    model.tearingThreshold = springs.tearingThreshold;
    for (Spring& spring : model.springs) {
        spring.stiffness = springs.stiffness;
        spring.damping = springs.damping;
    }
}

void healTissue(SoftModel& model)
{
    model.patched = false;
    setTissue(model);
}

void restartRelaxation(const SoftModel& model, SoftState& state)
{
    state.relaxation.assign(model.material.relaxation.empty() ? 0 : state.rotations.size(), {});
    state.unrelaxed = 0.0;
}

void setForces(const std::vector<physics::NodalForce>& forces, SoftState& state)
{
    std::fill(state.forces.begin(), state.forces.end(), Vec3{});
    for (const physics::NodalForce& force : forces) state.forces[force.node] += force.force;
}

} // namespace filasofia::engine
