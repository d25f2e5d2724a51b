#include "filasofia/engine/topology/loose_pieces.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/soft/rigid_motion.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// The matrix of an implicit step for one piece. Its nodes are numbered by their places in the piece's list.
class FragmentMatrix {
public:
    FragmentMatrix(const SoftModel& model, const BodyPiece& piece, ImplicitWeights weights, const SoftState& state)
        : stiffness_(weights.stiffness)
    {
        for (int node : piece.nodes) masses_.push_back(weights.mass * model.masses[static_cast<std::size_t>(node)]);
        for (int each : piece.elements) {
            const auto e = static_cast<std::size_t>(each);
            if (isShell(model)) {
                addTriangle(model.shell, e, piece, weights, state);
                continue;
            }
            const FemElement& element = model.elements[e];
            Part& part = parts_.emplace_back();
            part.element = &element;
            const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
            part.tangent = stepTangent(model, e, {f, toMat3(rotationOf(state.rotations, e))}, weights);
            part.places = placesOf(element.nodes, piece);
        }
    }

    [[nodiscard]] std::vector<Vec3> times(const std::vector<Vec3>& p) const
    {
        std::vector<Vec3> q;
        for (std::size_t i = 0; i < p.size(); ++i) q.push_back(masses_[i] * p[i]);
        for (const Part& part : parts_) {
            Corners corners;
            for (std::size_t k = 0; k < 4; ++k) corners[k] = p[part.places[k]];
            const Corners forces = stiffnessTimes(part.tangent, *part.element, corners);
            for (std::size_t k = 0; k < 4; ++k) q[part.places[k]] += stiffness_ * forces[k];
        }
        for (const auto& [places, tangent] : membranes_) addProduct(places, tangent, p, q);
        for (const auto& [places, tangent] : bends_) addProduct(places, tangent, p, q);
        return q;
    }

private:
    struct Part {
        const FemElement* element = nullptr;
        TissueTangent tangent;
        std::array<std::size_t, 4> places{};
    };
    template <std::size_t n>
    static std::array<std::size_t, n> placesOf(const std::array<int, n>& nodes, const BodyPiece& piece)
    {
        std::array<std::size_t, n> places;
        for (std::size_t k = 0; k < n; ++k)
            places[k] = static_cast<std::size_t>(std::ranges::lower_bound(piece.nodes, nodes[k]) - piece.nodes.begin());
        return places;
    }
    void addTriangle(const Shell& shell, std::size_t e, const BodyPiece& piece, ImplicitWeights weights,
                     const SoftState& state)
    {
        const MembraneElement& membrane = shell.membranes[e];
        membranes_.emplace_back(placesOf(membrane.nodes, piece),
                                membraneTangent(membrane, vectorsAt(membrane.nodes, state.x), weights.turning));
        if (shell.bends.empty()) return;
        const BendingElement& bend = shell.bends[e];
        bends_.emplace_back(placesOf(bend.nodes, piece), bendingTangent(bend, vectorsAt(bend.nodes, state.x)));
    }
    template <std::size_t n, class Tangent> void addProduct(const std::array<std::size_t, n>& places,
                                                            const Tangent& tangent, const std::vector<Vec3>& p,
                                                            std::vector<Vec3>& q) const
    {
        std::array<Vec3, n> corners;
        for (std::size_t k = 0; k < n; ++k) corners[k] = p[places[k]];
        const std::array<Vec3, n> forces = stiffnessTimes(tangent, corners);
        for (std::size_t k = 0; k < n; ++k) q[places[k]] += stiffness_ * forces[k];
    }
    double stiffness_;
    std::vector<double> masses_;
    std::vector<Part> parts_;
    std::vector<std::pair<std::array<std::size_t, 3>, MembraneTangent>> membranes_;
    std::vector<std::pair<std::array<std::size_t, 6>, BendingTangent>> bends_;
};

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += filasofia::dot(a[i], b[i]);
    return sum;
}

void add(double s, const std::vector<Vec3>& from, std::vector<Vec3>& to)
{
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += s * from[i];
}

/// Conjugate gradients in double precision. With so few unknowns they converge in about as many iterations.
std::vector<Vec3> solve(const FragmentMatrix& a, std::vector<Vec3> r)
{
    constexpr double kRelativeResidual = 1e-6; // [-] relative to the first residual
    std::vector<Vec3> x(r.size()), p = r;
    double rr = dot(r, r);
    const double enough = kRelativeResidual * kRelativeResidual * rr;
    for (std::size_t i = 0; i < 6 * r.size() && rr > enough; ++i) {
        const std::vector<Vec3> q = a.times(p);
        const double curvature = dot(p, q);
        if (!(curvature > 0.0)) break;
        add(rr / curvature, p, x);
        add(-rr / curvature, q, r);
        const double before = std::exchange(rr, dot(r, r));
        for (std::size_t k = 0; k < p.size(); ++k) p[k] = r[k] + rr / before * p[k];
    }
    return x;
}

} // namespace

std::vector<BodyPiece> findPieces(const SoftModel& model, const Pieces& pieces)
{
    constexpr std::size_t kMaxFragment = 32; // elements
    if (pieces.count() < 2) return {};
    const std::vector<int>& pieceOf = pieces.ofTetrahedron();
    std::vector<BodyPiece> list(static_cast<std::size_t>(*std::ranges::max_element(pieceOf)) + 1);
    for (std::size_t p = 0; p < list.size(); ++p) list[p].number = static_cast<int>(p);
    std::vector<int> ofNode(model.rest.size(), -1);
    for (std::size_t e = 0; e < pieceOf.size(); ++e) {
        const geometry::Tetrahedron of = elementNodes(model, e);
        for (int node : nodesOf(of)) ofNode[static_cast<std::size_t>(node)] = pieceOf[e];
        std::vector<int>& elements = list[static_cast<std::size_t>(pieceOf[e])].elements;
        if (elements.size() <= kMaxFragment) elements.push_back(static_cast<int>(e));
    }
    for (std::size_t i = 0; i < ofNode.size(); ++i)
        if (ofNode[i] >= 0) list[static_cast<std::size_t>(ofNode[i])].nodes.push_back(static_cast<int>(i));
    for (BodyPiece& piece : list)
        if (piece.elements.size() > kMaxFragment) piece.elements = {};
    std::erase_if(list,
                  [&](const BodyPiece& each) { return each.nodes.empty() || model.removed.contains(each.number); });
    findHeld(model.pins, list);
    return list;
}

void measure(const SoftModel& model, const SoftState& state, std::vector<physics::LoosePiece>& loose)
{
    for (physics::LoosePiece& each : loose) {
        const auto found = std::ranges::find(model.pieces, each.piece, &BodyPiece::number);
        if (found == model.pieces.end()) continue;
        Vec3 moment;
        for (const int node : found->nodes) {
            const auto n = static_cast<std::size_t>(node);
            each.mass += model.masses[n];
            moment += model.masses[n] * state.x[n];
        }
        each.place = 1.0 / each.mass * moment;
        each.held = found->held;
    }
}

void findHeld(const Pins& pins, std::vector<BodyPiece>& pieces)
{
    if (pieces.empty()) return;
    std::vector<bool> held(pins.hard);
    for (const PinSpring& pin : pins.springs) held[static_cast<std::size_t>(pin.node)] = true;
    const auto isHeld = [&](int node) { return held[static_cast<std::size_t>(node)]; };
    for (BodyPiece& piece : pieces) piece.held = std::ranges::any_of(piece.nodes, isHeld);
}

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

} // namespace

void finishFragments(SoftBody& body, ImplicitWeights weights, const std::vector<char>& constrained,
                     const std::function<NodeSolve(int node)>& solved)
{
    for (const BodyPiece& piece : body.model.pieces) {
        const auto isConstrained = [&](int node) { return constrained[static_cast<std::size_t>(node)] != 0; };
        if (piece.elements.empty() || piece.held || std::ranges::any_of(piece.nodes, isConstrained)) continue;
        if (sharesVolumes(body.model, piece)) continue; // its matrix would lack them
        std::vector<Vec3> impulses;
        for (int node : piece.nodes) impulses.push_back(solved(node).residual);
        const std::vector<Vec3> correction =
            solve(FragmentMatrix(body.model, piece, weights, body.state), std::move(impulses));
        for (std::size_t k = 0; k < correction.size(); ++k) {
            const auto i = static_cast<std::size_t>(piece.nodes[k]);
            body.system.dv[i] = solved(piece.nodes[k]).dv + correction[k];
            body.system.residual[i] = {};
        }
        limitShape(body.model, body.state, piece, weights.damping, body.system.dv); // damping: weighed by dt
    }
}

void limitSpin(const SoftModel& model, double maxTurn, double dt, SoftState& state)
{
    for (const BodyPiece& piece : model.pieces) {
        if (piece.held) continue;
        const auto at = [&](int i) { return static_cast<std::size_t>(piece.nodes[static_cast<std::size_t>(i)]); };
        const RigidMotion motion = rigidMotionOf(
            static_cast<int>(piece.nodes.size()), [&](int i) { return model.masses[at(i)]; },
            [&](int i) { return state.x[at(i)]; }, [&](int i) { return model.masses[at(i)] * state.v[at(i)]; });
        const double turn = dt * length(motion.angular);
        if (!(turn > maxTurn) || !isFinite(motion.angular)) continue;
        const Vec3 excess = (1.0 - maxTurn / turn) * motion.angular;
        for (int node : piece.nodes) {
            const auto i = static_cast<std::size_t>(node);
            state.v[i] -= cross(excess, state.x[i] - motion.centre);
        }
    }
}

std::vector<int> piecesBeyond(double far, const SoftModel& model, const SoftState& state)
{
    std::vector<PiecePlace> places;
    for (const BodyPiece& piece : model.pieces) {
        const auto first = static_cast<std::size_t>(piece.nodes.front());
        places.push_back({piece.number, piece.nodes.size(), state.x[first], model.rest[first]});
    }
    return piecesBeyond(far, places);
}

} // namespace filasofia::engine
