#include "filasofia/engine/contact/fragment_solves.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/soft/fragment_operator.h"
#include "filasofia/engine/soft/rigid_motion.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// [-] A fragment changes its shape by no more than this share of its size at rest in a step. Tears leave elements that
/// are stretched far or inside out, for which the tangent of a step is not good for more: some were thrown off at
/// thousands of metres per second.
constexpr double kMostChange = 0.5;

/// Whether nodes of a fragment bear volumes (body/nodal_volume.h).
bool sharesVolumes(const SoftModel& model, const BodyPiece& piece)
{
    return model.nodalVolumes && std::ranges::any_of(piece.elements, [&](int e) {
               return nodalBulk(model.elements[static_cast<std::size_t>(e)]) > 0.0;
           });
}

/// Takes from the solved velocities what changes the shape of a fragment too fast. Its linear and angular momentum
/// stay.
void limitShape(const SoftModel& model, const SoftState& state, const BodyPiece& piece, double dt,
                std::vector<Vec3>& dv)
{
    const auto at = [&](int i) { return static_cast<std::size_t>(piece.nodes[static_cast<std::size_t>(i)]); };
    const int count = static_cast<int>(piece.nodes.size());
    const auto velocity = [&](int i) { return state.v[at(i)] + dv[at(i)]; };
    const RigidMotion motion = rigidMotionOf(
        count, [&](int i) { return model.masses[at(i)]; }, [&](int i) { return state.x[at(i)]; },
        [&](int i) { return model.masses[at(i)] * velocity(i); });
    const auto change = [&](int i) {
        return velocity(i) - motion.linear - cross(motion.angular, state.x[at(i)] - motion.centre);
    };
    double fastest = 0.0, size = 0.0;
    for (int i = 0; i < count; ++i) {
        fastest = std::max(fastest, length(change(i)));
        size = std::max(size, distance(model.rest[at(i)], model.rest[at(0)]));
    }
    const double share = kMostChange * size / (dt * fastest);
    if (!(share < 1.0) || !isFinite(motion.angular)) return;
    for (int i = 0; i < count; ++i) dv[at(i)] -= (1.0 - share) * change(i);
}

/// Whether the body's fragments can be solved apart: their matrix is that of elements in an implicit step.
bool mayPart(const SoftBody& body)
{
    return !body.model.pieces.empty() && body.system.matrixFree && body.model.springs.empty() &&
           std::holds_alternative<physics::ImplicitEuler>(body.model.integrator);
}
bool mayPart(const SoftModel& model, const BodyPiece& piece)
{
    return !piece.elements.empty() && !piece.held && !sharesVolumes(model, piece); // its matrix would lack them
}

/// Whether no element of the fragment is near to being inside out, or stretched far. What a tear leaves so is thrown by
/// the wall that it touches if it is solved exactly, at thousands of metres per second; in the solve of its body, which
/// then ends too early, it is not.
bool isSound(const SoftModel& model, const SoftState& state, const BodyPiece& piece)
{
    constexpr double leastVolume = 0.2, mostStretch = 3.0; // [-]
    return isShell(model) || std::ranges::all_of(piece.elements, [&](int e) {
               const FemElement& element = model.elements[static_cast<std::size_t>(e)];
               const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
               return determinant(f) > leastVolume && trace(transpose(f) * f) < mostStretch * mostStretch;
           });
}

/// Per node of a body, the place of its fragment in `list`; -1: none. Empty if the body has none.
using FragmentOfNode = std::vector<int>;

std::vector<FragmentOfNode> listFragments(const Scene& scene, std::vector<FragmentSolve>& list)
{
    std::vector<FragmentOfNode> ofNodes(scene.soft.size());
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        const SoftModel& model = scene.soft[b].model;
        if (!mayPart(scene.soft[b])) continue;
        for (std::size_t p = 0; p < model.pieces.size(); ++p) {
            if (!mayPart(model, model.pieces[p])) continue;
            ofNodes[b].resize(model.rest.size(), -1);
            for (int node : model.pieces[p].nodes)
                ofNodes[b][static_cast<std::size_t>(node)] = static_cast<int>(list.size());
            list.push_back({b, p, {}});
        }
    }
    return ofNodes;
}

/// The rows of the constraints over the nodes of the fragment.
void listRows(const FragmentSolve& fragment, const BodyPiece& piece, std::span<Constraint> constraints,
              ConstraintRows& rows)
{
    for (std::size_t c : fragment.constraints) {
        Constraint& each = constraints[c];
        ConstraintRow& row = rows.list.emplace_back(ConstraintRow{&each, static_cast<int>(rows.points.size()), 0, {}});
        for (std::size_t side = 0; side < 2; ++side) {
            const BodyPoint& at = each.sides[side];
            if (at.of != BodyPoint::Of::Soft) continue;
            for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k) {
                const auto place = std::ranges::lower_bound(piece.nodes, at.nodes[k]) - piece.nodes.begin();
                rows.points.push_back({static_cast<int>(place), side == 0 ? at.weights[k] : -at.weights[k]});
                ++row.count;
            }
        }
    }
}

} // namespace

FragmentSolves findFragmentSolves(const Scene& scene, const RigidPlan& plan, std::span<const Constraint> constraints)
{
    FragmentSolves solves;
    std::vector<FragmentSolve> all;
    const std::vector<FragmentOfNode> ofNodes = listFragments(scene, all);
    if (all.empty()) return solves;
    std::vector<char> bound(all.size()); // acts on what moves
    for (std::size_t c = 0; c < constraints.size(); ++c)
        for (std::size_t side = 0; side < 2; ++side) {
            const BodyPoint& at = constraints[c].sides[side];
            if (at.of != BodyPoint::Of::Soft || at.count == 0 || ofNodes[at.body].empty()) continue;
            const int of = ofNodes[at.body][static_cast<std::size_t>(at.nodes[0])];
            if (of < 0) continue;
            const auto fragment = static_cast<std::size_t>(of);
            if (unitOf(scene.soft.size(), plan, constraints[c].sides[1 - side])) bound[fragment] = 1;
            all[fragment].constraints.push_back(c);
        }
    solves.apart.resize(constraints.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const SoftBody& body = scene.soft[all[i].body];
        const bool touches = !all[i].constraints.empty();
        if (bound[i] != 0 || (touches && !isSound(body.model, body.state, body.model.pieces[all[i].piece]))) continue;
        for (std::size_t c : all[i].constraints) solves.apart[c] = 1;
        solves.list.push_back(std::move(all[i]));
    }
    return solves;
}

void setAside(FragmentSolve& fragment, SoftBody& body)
{
    fragment.impulses.clear();
    for (int node : body.model.pieces[fragment.piece].nodes) {
        fragment.impulses.push_back(body.system.matrixFree->takeImpulse(node));
        body.system.dv[static_cast<std::size_t>(node)] = {};
    }
}

CoupledReport solveFragment(double dt, const CoupledLimits& limits, const FragmentSolve& fragment, SoftBody& body,
                            std::span<Constraint> constraints, CoupledSolve& solver)
{
    const SoftModel& model = body.model;
    const BodyPiece& piece = model.pieces[fragment.piece];
    const ImplicitWeights weights = implicitWeights(dt, {model.rayleigh.mass, model.rayleigh.stiffness},
                                                    relaxationTangent(model.material.relaxation, dt));
    std::vector<Vec3> guess;
    std::vector<ContactPoint> points;
    for (std::size_t k = 0; k < piece.nodes.size(); ++k) {
        guess.push_back(body.state.dv[static_cast<std::size_t>(piece.nodes[k])]);
        points.push_back({.node = static_cast<int>(k)});
    }
    FragmentOperator matrix(FragmentMatrix(model, piece, weights, body.state), fragment.impulses, guess);
    CoupledReport report;
    if (matrix.usable()) {
        ConstraintRows rows;
        listRows(fragment, piece, constraints, rows);
        report = solver.solve(limits, {coupled(matrix)}, {points}, rows);
    }
    for (std::size_t k = 0; k < piece.nodes.size(); ++k) {
        const auto node = static_cast<std::size_t>(piece.nodes[k]);
        body.system.dv[node] = matrix.usable() ? matrix.answer()[k] : 1.0 / model.masses[node] * fragment.impulses[k];
        body.system.residual[node] = {};
    }
    limitShape(model, body.state, piece, dt, body.system.dv);
    return report;
}

} // namespace filasofia::engine
