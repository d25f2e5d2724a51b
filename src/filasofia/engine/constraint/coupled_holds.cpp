// Bodies that others hold: the part of CoupledSolve that finds how much they yield. A tool of 0.1 g that a hand pushed
// against tissue stayed behind, as its attachment was as soft as the tool is light (docs/lab/contact.md).
#include "filasofia/engine/constraint/coupled_solve.h"

namespace filasofia::engine {
namespace {

// Per body. One is a hinge, about which a body turns. Each costs three solves with D.
constexpr std::size_t kFewestAttachments = 2, kMostAttachments = 8;
// Relative to the mean compliance of the attachments: several may hold the same motion. Also the least share
// of what a row yields alone that is left to it.
constexpr double kShift = 1e-4;
// Bodies that bear each other. A bob on a clip on tissue fell by 0.7 m in a second, as the penalty between clip and bob
// followed the clip's 10 mg alone, and not the tissue behind it.
constexpr int kDeepest = 4;

} // namespace

void CoupledSolve::findHolds()
{
    holds_.assign(bodies_->size(), {});
    const auto isExact = [&](const Side& side) { return side.body && (*bodies_)[*side.body].smoother->isExact(); };
    for (std::size_t c = 0; c < rows_.size(); ++c)
        for (std::size_t k = 0; k < 2; ++k) {
            const Side &own = sides_[c][k], &tissue = sides_[c][1 - k];
            const bool pushes = !constraint(c).bilateral() && rows_[c].law.impulse.x > 0.0;
            if (pushes && isExact(own) && tissue.body && !isExact(tissue) && tissue.along > 0.0)
                holds_[*own.body].pushes = true;
        }
    for (std::size_t c = 0; c < rows_.size(); ++c)
        for (const Side& own : sides_[c])
            if (constraint(c).kind == ConstraintKind::Weld && own.body && holds_[*own.body].pushes)
                holds_[*own.body].attachments.push_back(c);
    for (std::size_t b = 0; b < holds_.size(); ++b) {
        // Rods are left out: with its needle as a hold, a stitch in soft tissue turned elements inside out in 200
        // steps, and its thread pressed with 22 N in place of 0.3 N.
        std::vector<std::size_t>& attachments = holds_[b].attachments;
        if ((*bodies_)[b].smoother->couplesNodes() || attachments.size() < kFewestAttachments ||
            attachments.size() > kMostAttachments)
            attachments.clear();
        else
            measureHold(b);
    }
}

void CoupledSolve::measureHold(std::size_t body)
{
    Hold& hold = holds_[body];
    const auto first = static_cast<std::size_t>(first_[body]),
               count = static_cast<std::size_t>(first_[body + 1]) - first;
    const CoupledBody& own = (*bodies_)[body];
    std::vector<Vec3> impulses(count), before(count), after(count);
    const auto forEachPoint = [&](std::size_t c, const auto& use) {
        for (const WeightedPoint& each : constraints_->pointsOf(constraints_->list[c]))
            if (const auto at = static_cast<std::size_t>(each.point); at >= first && at < first + count)
                use(at - first, each.weight);
    };
    // The vector z is free until the first iteration.
    own.matrix->read(SolveVector::Preconditioned, before);
    for (const std::size_t c : hold.attachments)
        for (int axis = 0; axis < 3; ++axis) {
            std::ranges::fill(impulses, Vec3{});
            forEachPoint(c, [&](std::size_t at, double weight) { impulses[at][axis] += weight; });
            own.preconditioner->subtractSmoothed(impulses);
            own.matrix->read(SolveVector::Preconditioned, after);
            for (std::size_t k = 0; k < count; ++k) hold.answers.push_back(before[k] - after[k]);
            before.swap(after);
        }
    const std::size_t size = 3 * hold.attachments.size();
    std::vector<double> compliance(size * size);
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t c = hold.attachments[i / 3];
        const Side& other = sides_[c][sides_[c][0].body == body ? 1 : 0];
        const double softness = constraint(c).softness;
        for (std::size_t j = 0; j <= i; ++j)
            forEachPoint(c, [&](std::size_t at, double weight) {
                compliance[i * size + j] += weight * hold.answers[j * count + at][static_cast<int>(i % 3)];
            });
        sum += compliance[i * size + i];
        compliance[i * size + i] += other.inAll / 3.0 + (softness > 0.0 ? 1.0 / softness : 0.0);
    }
    for (std::size_t i = 0; i < size; ++i) compliance[i * size + i] += kShift * sum / static_cast<double>(size);
    if (!hold.factor.factorise(compliance, static_cast<int>(size))) hold.attachments.clear();
}

bool CoupledSolve::bears(std::size_t c, std::size_t side) const
{
    if (!sides_[c][side].body) return false;
    const BodySmoother& smoother = *(*bodies_)[*sides_[c][side].body].smoother;
    return smoother.isExact() && (constraint(c).sides[side].of != BodyPoint::Of::Soft || smoother.couplesNodes());
}

void CoupledSolve::findBurdens()
{
    burdens_.assign(bodies_->size(), {});
    if (exact_) return; // the filter knows them
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& each = constraint(c);
        const auto turns = [](const BodyPoint& side) {
            return side.of == BodyPoint::Of::RodEdge || side.of == BodyPoint::Of::Turning;
        };
        const bool welds =
            each.kind == ConstraintKind::Weld && each.softness == 0.0 && std::ranges::none_of(each.sides, turns);
        const bool pushes = each.kind == ConstraintKind::Contact && rows_[c].law.impulse.x > 0.0;
        for (std::size_t k = 0; k < 2; ++k) {
            const Side &own = sides_[c][k], &other = sides_[c][1 - k];
            if (!bears(c, k) || own.body == other.body || !(own.inAll > 0.0)) continue;
            const bool moves = other.inAll > 0.0;
            if (!welds && (!pushes || !moves || (*bodies_)[*own.body].smoother->couplesNodes())) continue;
            const double inertia = moves ? 3.0 / other.inAll : std::numeric_limits<double>::infinity();
            std::vector<Burden>& burdens = burdens_[*own.body];
            auto at = std::ranges::find(burdens, other.body, &Burden::other);
            if (at == burdens.end()) at = burdens.insert(at, {other.body});
            // The nodes of tissue add up; what is rigid is the same body at each of its contacts.
            at->own = other.body && !bears(c, 1 - k) ? at->own + inertia : std::max(at->own, inertia);
            at->all = at->own;
        }
    }
    if (std::ranges::all_of(burdens_, [](const auto& each) { return each.size() < 2; })) return;
    for (int depth = 1; depth < kDeepest; ++depth) { // each pass hands on what the one before has found
        const std::vector<std::vector<Burden>> found = burdens_;
        for (std::size_t b = 0; b < burdens_.size(); ++b)
            for (Burden& each : burdens_[b]) {
                each.all = each.own;
                if (!each.other) continue;
                for (const Burden& next : found[*each.other])
                    if (next.other != b) each.all += next.all;
            }
    }
}

double CoupledSolve::inertiaAt(std::size_t c, std::size_t side) const
{
    const Side &own = sides_[c][side], &other = sides_[c][1 - side];
    if (!(own.along > 0.0)) return std::numeric_limits<double>::infinity();
    // A rod bears along itself what is tied to it, and nothing across, where it is touched. A contact with what cannot
    // move bounds the impulse of what has no room by its penalty (trappedAt).
    const bool touches = !constraint(c).bilateral();
    if (!own.body || (touches && ((*bodies_)[*own.body].smoother->couplesNodes() || !(other.along > 0.0))))
        return 1.0 / own.along;
    double burden = 0.0;
    for (const Burden& each : burdens_[*own.body])
        if (each.other != other.body) burden += each.all;
    // Where no tissue yields, nothing else would bound it: bodies that stand in a ring bear each other.
    const bool yields = (sides_[c][0].body && !bears(c, 0)) || (sides_[c][1].body && !bears(c, 1));
    return 1.0 / own.along + (yields ? burden : std::min(burden, whole_));
}

double CoupledSolve::burdened(std::size_t c, double free) const
{
    const auto isBurdened = [&](std::size_t k) {
        const std::array<Side, 2>& sides = sides_[c];
        return sides[k].body && std::ranges::any_of(burdens_[*sides[k].body], [&](const Burden& each) {
                   return each.other != sides[1 - k].body;
               });
    };
    if (!isBurdened(0) && !isBurdened(1)) return free;
    return std::clamp(1.0 / inertiaAt(c, 0) + 1.0 / inertiaAt(c, 1), kShift * free, free);
}

bool CoupledSolve::isHeld(const Side& side) const { return side.body && !holds_[*side.body].attachments.empty(); }

Mat3 CoupledSolve::takenByHold(std::size_t c, std::size_t side)
{
    const std::size_t body = *sides_[c][side].body;
    const Hold& hold = holds_[body];
    const auto first = static_cast<std::size_t>(first_[body]),
               count = static_cast<std::size_t>(first_[body + 1]) - first;
    Mat3 taken; // point by point, as sidesOf() adds up what is free: so more than that is never taken
    for (const WeightedPoint& each : constraints_->pointsOf(constraints_->list[c])) {
        const auto at = static_cast<std::size_t>(each.point);
        if (sideOf(each) != side || at < first || at >= first + count) continue;
        for (int axis = 0; axis < 3; ++axis) {
            held_.clear();
            for (std::size_t i = 0; i < 3 * hold.attachments.size(); ++i)
                held_.push_back(hold.answers[i * count + at - first][axis]);
            hold.factor.solve(held_);
            for (std::size_t i = 0; i < held_.size(); ++i)
                taken[axis] += each.weight * each.weight * held_[i] * hold.answers[i * count + at - first];
        }
    }
    return taken;
}

double CoupledSolve::compliancePressed(std::size_t c, double kappa)
{
    const std::array<Side, 2>& sides = sides_[c];
    const Constraint& each = constraint(c);
    if (each.bilateral()) return burdened(c, sides[0].along + sides[1].along);
    // A rod's side has the kappa that rods have on rigid bodies. The filter knows the rod as it is, so that costs no
    // iterations. With the 3 to 10 of tissue, contacts learn over many steps what a bent wire of some milligrams
    // presses with, and it sinks in.
    std::array<double, 2> shares{1.0, 1.0};
    double free = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
        const BodySmoother* smoother = sides[k].body ? (*bodies_)[*sides[k].body].smoother : nullptr;
        if (smoother && smoother->isExact() && smoother->couplesNodes())
            shares[k] = std::min(1.0, kappa / limits_->exactKappa.contact);
        free += shares[k] * sides[k].along;
    }
    if (std::ranges::none_of(sides, [&](const Side& side) { return isHeld(side); })) return burdened(c, free);
    Mat3 all = kShift * (shares[0] * sides[0].inAll + shares[1] * sides[1].inAll) * Mat3::identity();
    for (const WeightedPoint& at : constraints_->pointsOf(constraints_->list[c]))
        all += shares[sideOf(at)] * at.weight * at.weight * compliance_[static_cast<std::size_t>(at.point)];
    for (std::size_t k = 0; k < 2; ++k)
        if (isHeld(sides[k])) all -= shares[k] * takenByHold(c, k);
    // Where the two rub, they hold each other across the normal: a tip that is softer sideways does not yield by that.
    const Vec3 normal = each.frame[0];
    const double yields = each.friction > 0.0 ? 1.0 / dot(normal, inverse(all) * normal) : dot(normal, all * normal);
    return std::clamp(yields, kShift * free, free);
}

} // namespace filasofia::engine
