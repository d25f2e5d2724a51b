#include "filasofia/engine/topology/tear_body.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/rupture/stress.h"
#include "filasofia/engine/topology/apply_edit.h"
#include "filasofia/math/polar.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr int kElementsPerPart = 256;

/// `changes`: those of the volumes of nodes.
Mat3 stressOf(const SoftModel& model, const SoftState& state, std::size_t e, double threshold,
              std::span<const double> changes)
{
    const FemElement& element = model.elements[e];
    const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
    if (!hasLawAlone(model)) {
        const Mat3 own = endStress(model, state, e, f);
        return own == Mat3{} ? own : own + nodalTension(element, changes) * Mat3::identity();
    }
    const Lame material = lameOf(element);
    const Quat before = rotationOf(state.rotations, e);
    // Only the corotational stress with the last step's rotation is near the true one, however far the element turned.
    if (std::holds_alternative<physics::Corotational>(model.material.law)) {
        const Mat3 withOldRotation = cauchyStress(model.material.law, material, {f, toMat3(before)});
        if (principalStressBound(withOldRotation) < kStressNear * threshold) return {};
    }
    const Mat3 stress = cauchyStress(model.material.law, material, {f, toMat3(polarRotation(f, before))});
    // The default solver's search leaves out elements below this: so does this one.
    const double near = kStressNear * threshold;
    const bool isBelow = principalStressBound(stress) < near || principalStress(stress).value < near;
    return isBelow && !std::holds_alternative<physics::Corotational>(model.material.law) ? Mat3{} : stress;
}

/// That in a triangle; zero below what other elements leave out.
Mat3 stressInSheet(const SoftModel& model, const SoftState& state, std::size_t e, double threshold)
{
    const MembraneElement& element = model.shell.membranes[e];
    const TriangleCorners x = vectorsAt(element.nodes, state.x);
    const double thickness = model.shell.material.thickness;
    const bool isBelow = membranePrincipalStress(element, x, thickness) < kStressNear * threshold;
    return isBelow ? Mat3{} : membraneStress(element, x, thickness);
}

Mat3 stressOf(const SoftModel& model, const SoftState& state, std::size_t e, const SpringsOfElements& springs)
{
    const Corners corners = cornersOf(model.tetrahedra[e], state.x);
    std::array<double, 6> tensions{};
    for (std::size_t k = 0; k < 6; ++k) {
        const auto s = static_cast<std::size_t>(springs.ofElement[e][k]);
        const Spring& spring = model.springs[s];
        const Vec3 a = state.x[static_cast<std::size_t>(spring.nodes[0])],
                   b = state.x[static_cast<std::size_t>(spring.nodes[1])];
        tensions[k] = spring.stiffness * (distance(a, b) - spring.restLength) / springs.sharedBy[s];
    }
    return virialStress(corners, tensions);
}

} // namespace

bool findStresses(const SoftModel& model, const SoftState& state, const StressSearch& search, WorkerPool& pool,
                  std::vector<Mat3>& stresses)
{
    const double threshold = search.threshold; // clang 14 captures no structured bindings
    const SpringsOfElements& springs = search.springs;
    const auto& stressed = search.stressed;
    const bool fem = !model.elements.empty();
    stresses.resize(elementCount(model));
    const linalg::Parts parts{static_cast<int>(stresses.size()), kElementsPerPart};
    const std::vector<double> changes = volumeChanges(model, state.x);
    std::vector<char> above(static_cast<std::size_t>(parts.count()));
    pool.run(parts.count(), [&](int part) {
        const linalg::Blocks range = parts[part];
        for (auto e = static_cast<std::size_t>(range.begin); e < static_cast<std::size_t>(range.end); ++e) {
            const bool isNear = stressed.empty() || (stressed[e / kBlock] >> e % kBlock & 1) != 0;
            if (!isNear || allHeld(model, e)) { // not near the threshold, or fixed (pinned or removed)
                stresses[e] = {};
                continue;
            }
            stresses[e] = fem              ? stressOf(model, state, e, threshold, changes)
                          : isShell(model) ? stressInSheet(model, state, e, threshold)
                                           : stressOf(model, state, e, springs);
            if (fem && model.elements[e].tearingThreshold != threshold) // relative to what this element bears
                stresses[e] = threshold / model.elements[e].tearingThreshold * stresses[e];
            if (principalStressBound(stresses[e]) > threshold) above[static_cast<std::size_t>(part)] = 1;
        }
    });
    return std::ranges::find(above, 1) != above.end();
}

SpringsOfElements springsOfElements(const SoftModel& model)
{
    SpringsOfElements out;
    out.sharedBy.assign(model.springs.size(), 0);
    for (const geometry::Tetrahedron& nodes : model.tetrahedra) {
        std::array<int, 6>& of = out.ofElement.emplace_back();
        for (std::size_t k = 0; k < 6; ++k) { // springs are sorted by their nodes, the lower one first
            std::array<int, 2> ends{nodes[geometry::kTetrahedronEdges[k][0]], nodes[geometry::kTetrahedronEdges[k][1]]};
            std::ranges::sort(ends);
            const auto spring = std::ranges::lower_bound(model.springs, ends, {}, &Spring::nodes);
            of[k] = static_cast<int>(spring - model.springs.begin());
            ++out.sharedBy[static_cast<std::size_t>(of[k])];
        }
    }
    return out;
}

void tearBody(SoftBody& body, WorkerPool& pool, physics::TopologyReport& report)
{
    const SoftModel& model = body.model;
    const SoftState& state = body.state;
    BodyTopology& topology = body.topology;
    const double threshold = model.tearingThreshold;
    if (!(threshold < std::numeric_limits<double>::infinity())) return;
    std::vector<std::uint16_t>& stressed = topology.stressed;
    stressed.clear();
    if (body.system.matrixFree && !model.elements.empty() &&
        !body.system.matrixFree->findStressed(model, state, kStressNear * threshold, pool, stressed))
        return;
    if (!model.springs.empty() && topology.springs.ofElement.empty()) topology.springs = springsOfElements(model);
    if (!findStresses(model, state, {threshold, topology.springs, stressed}, pool, topology.stresses)) return;
    EditableMesh& mesh = *topology.mesh;
    if (!topology.followed) mesh.placeAt(state.x); // otherwise cutBodies() has moved it already
    topology.held.assign(model.rest.size(), 0);
    for (std::size_t i = 0; i < model.rest.size(); ++i) topology.held[i] = model.pins.hard[i] ? 1 : 0;
    const RuptureReport done = topology.tearing.step(mesh, topology.stresses, topology.held, {.threshold = threshold});
    topology.torn += done;
    add(done, report);
}

} // namespace filasofia::engine
