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
    constexpr double leastVolume = 0.2, mostStretched = 9.0; // [-] the sum of the squared principal stretches
    return isShell(model) || std::ranges::all_of(piece.elements, [&](int e) {
               const FemElement& element = model.elements[static_cast<std::size_t>(e)];
               const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
               return determinant(f) > leastVolume && trace(transpose(f) * f) < mostStretched;
           });
}

/// Per node of a body, whether it is one of a cavity's wall; empty without cavities.
std::vector<char> wallNodes(const SoftModel& model)
{
    std::vector<char> nodes;
    if (model.wallOf.empty()) return nodes;
    nodes.resize(model.rest.size());
    for (std::size_t t = 0; t < model.surface.size(); ++t)
        for (int node : model.surface[t])
            if (model.wallOf[t] >= 0) nodes[static_cast<std::size_t>(node)] = 1;
    return nodes;
}

/// Per node of a body, the place of its fragment in `list`; -1: none. Empty if the body has none.
using FragmentOfNode = std::vector<int>;

std::vector<FragmentOfNode> listFragments(const Scene& scene, std::vector<FragmentSolve>& list)
{
    std::vector<FragmentOfNode> ofNodes(scene.soft.size());
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        const SoftModel& model = scene.soft[b].model;
        if (!mayPart(scene.soft[b])) continue;
        const std::vector<char> walls = wallNodes(model);
        const auto isWall = [&](int node) { return !walls.empty() && walls[static_cast<std::size_t>(node)] != 0; };
        for (std::size_t p = 0; p < model.pieces.size(); ++p) {
            const BodyPiece& piece = model.pieces[p];
            if (!mayPart(model, piece) || std::ranges::any_of(piece.nodes, isWall)) continue;
            ofNodes[b].resize(model.rest.size(), -1);
            for (int node : piece.nodes) ofNodes[b][static_cast<std::size_t>(node)] = static_cast<int>(list.size());
            list.push_back({b, p, {}});
        }
    }
    return ofNodes;
}

/// The rows of the fragment's constraints over the nodes that they act on.
void listRows(const FragmentSolve& fragment, const BodyPiece& piece, std::span<Constraint> constraints,
              std::vector<ContactPoint>& points, ConstraintRows& rows)
{
    std::vector<int> pointOf(piece.nodes.size(), -1);
    for (std::size_t c : fragment.constraints) {
        Constraint& each = constraints[c];
        ConstraintRow& row = rows.list.emplace_back(ConstraintRow{&each, static_cast<int>(rows.points.size()), 0, {}});
        for (std::size_t side = 0; side < 2; ++side) {
            const BodyPoint& at = each.sides[side];
            if (at.of != BodyPoint::Of::Soft) continue;
            for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k) {
                const auto place = std::ranges::lower_bound(piece.nodes, at.nodes[k]) - piece.nodes.begin();
                int& point = pointOf[static_cast<std::size_t>(place)];
                if (point < 0) {
                    point = static_cast<int>(points.size());
                    points.push_back({.node = static_cast<int>(place)});
                }
                rows.points.push_back({point, side == 0 ? at.weights[k] : -at.weights[k]});
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
            const auto nodes = std::span(at.nodes).first(static_cast<std::size_t>(at.count));
            const auto fragmentAt = [&](int node) { return ofNodes[at.body][static_cast<std::size_t>(node)]; };
            const int only = fragmentAt(nodes[0]);
            // A point of a collision mesh that does not open may be on several pieces.
            const bool shared = std::ranges::any_of(nodes, [&](int node) { return fragmentAt(node) != only; });
            const bool moves = unitOf(scene.soft.size(), plan, constraints[c].sides[1 - side]).has_value();
            for (int node : nodes)
                if (const int of = fragmentAt(node); of >= 0 && (shared || moves))
                    bound[static_cast<std::size_t>(of)] = 1;
            if (only >= 0) all[static_cast<std::size_t>(only)].constraints.push_back(c);
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
    std::vector<Vec3> guess;
    for (int node : piece.nodes) guess.push_back(body.state.dv[static_cast<std::size_t>(node)]);
    FragmentOperator matrix(fragmentMatrix(model, piece, dt, body.state), fragment.impulses, guess);
    CoupledReport report;
    report.converged = matrix.usable();
    if (matrix.usable()) {
        std::vector<ContactPoint> points;
        ConstraintRows rows;
        listRows(fragment, piece, constraints, points, rows);
        report = solver.solve(limits, {coupled(matrix)}, {points}, rows);
    }
    for (std::size_t c : fragment.constraints)
        for (Vec3* each : {&constraints[c].impulse, &constraints[c].multiplier})
            if (!matrix.usable() || !isFinite(*each)) *each = {};
    for (std::size_t k = 0; k < piece.nodes.size(); ++k) {
        const auto node = static_cast<std::size_t>(piece.nodes[k]);
        body.system.dv[node] = matrix.usable() ? matrix.answer()[k] : 1.0 / model.masses[node] * fragment.impulses[k];
        body.system.residual[node] = {};
    }
    limitShape(model, body.state, piece, dt, body.system.dv);
    return report;
}

} // namespace filasofia::engine
