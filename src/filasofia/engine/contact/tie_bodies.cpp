#include "filasofia/engine/contact/tie_bodies.h"

#include "filasofia/engine/scene/find_body.h"
#include "filasofia/math/polar.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

// Ties are made anew if an attachment has lost or gained this share of its pairs, or if its bodies have turned against
// each other by this angle, as two flaps do that are sewn along an edge. That is looked at every so many steps.
constexpr std::size_t kOtherPairs = 8;   // one in so many
constexpr double kOtherTurn = 0.3;       // [rad]
constexpr std::uint64_t kLookEvery = 16; // steps

/// A body whose coarse level can be tied.
const SoftBody* tieable(const Scene& scene, BodyId id)
{
    const auto place = findBody(scene, id);
    if (!place || !place->soft) return nullptr;
    const SoftBody& body = scene.soft[place->index];
    return body.system.matrixFree && body.system.matrixFree->coarseNodes() > 0 ? &body : nullptr;
}

/// An attachment between two such bodies.
struct Between {
    const Attachment* attachment = nullptr;
    std::array<const SoftBody*, 2> sides = {};
};

std::vector<Between> attachmentsBetween(const Scene& scene)
{
    std::vector<Between> out;
    for (const Attachment& each : scene.attachments) {
        const SoftBody *body = tieable(scene, each.body), *to = tieable(scene, each.to);
        if (body && to && !each.pairs.empty()) out.push_back({&each, {body, to}});
    }
    return out;
}

bool isFree(const SoftBody& body, const NodeWeight& each)
{
    return !body.model.pins.hard[static_cast<std::size_t>(each.node)];
}

/// How the second side is turned against the first: the mean over the pairs.
Mat3 turnOf(const Between& tie)
{
    Mat3 sum;
    for (const auto& pair : tie.attachment->pairs) {
        std::array<Mat3, 2> mean = {};
        for (std::size_t side = 0; side < 2; ++side)
            for (const NodeWeight& each : pair[side].nodes)
                if (isFree(*tie.sides[side], each))
                    mean[side] += each.weight * tie.sides[side]->system.matrixFree->rotation(each.node);
        sum += transpose(mean[0]) * mean[1];
    }
    return toMat3(polarRotation(sum, {}));
}

/// Whether the ties that were made still serve.
bool stillServe(const Scene& scene, std::span<const Between> now)
{
    const std::vector<Ties::Made>& made = scene.ties.made;
    if (made.size() != now.size()) return false;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const std::size_t pairs = now[i].attachment->pairs.size();
        if (made[i].attachment != now[i].attachment->id) return false;
        if (kOtherPairs * (std::max(pairs, made[i].pairs) - std::min(pairs, made[i].pairs)) > made[i].pairs)
            return false;
        for (const SoftBody* side : now[i].sides)
            if (!side->system.matrixFree->isTied()) return false;
        if (scene.step % kLookEvery != 0) continue;
        const double cosine = 0.5 * (trace(transpose(made[i].turn) * turnOf(now[i])) - 1.0);
        if (cosine < std::cos(kOtherTurn)) return false;
    }
    return true;
}

/// The groups of bodies that attachments connect, each ascending.
std::vector<std::vector<const SoftBody*>> groupsOf(std::span<const Between> ties)
{
    std::vector<std::vector<const SoftBody*>> groups;
    for (const Between& tie : ties) {
        std::vector<const SoftBody*> merged(tie.sides.begin(), tie.sides.end());
        std::erase_if(groups, [&](const std::vector<const SoftBody*>& group) {
            const bool meets = std::ranges::any_of(
                tie.sides, [&](const SoftBody* side) { return std::ranges::count(group, side) > 0; });
            if (meets) merged.insert(merged.end(), group.begin(), group.end());
            return meets;
        });
        std::ranges::sort(merged, {}, [](const SoftBody* body) { return body->model.id; });
        merged.erase(std::unique(merged.begin(), merged.end()), merged.end());
        groups.push_back(std::move(merged));
    }
    return groups;
}

/// Collects the coarse nodes and the pairs of one group.
class TieBuilder {
public:
    TieBuilder(double dt, std::span<const SoftBody* const> bodies) : dt_(dt), bodies_(bodies.begin(), bodies.end())
    {
        picked.resize(bodies_.size());
        for (const SoftBody* body : bodies_) shares_.emplace_back(body->model.rest.size());
    }

    std::vector<std::vector<int>> picked; ///< per body: coarse nodes, ascending

    [[nodiscard]] bool has(const Between& tie) const { return std::ranges::count(bodies_, tie.sides[0]) > 0; }
    /// To be called for all ties before the first pairsOf(): which coarse nodes there are, and how many pairs share a
    /// node's smoother.
    void count(const Between& tie)
    {
        forEachNode(tie, [&](std::size_t, std::size_t body, const NodeWeight& each) {
            shares_[body][static_cast<std::size_t>(each.node)] += std::abs(each.weight);
            const linalg::Interpolation how = bodies_[body]->system.matrixFree->coarseWeights(each.node);
            for (std::size_t k = 0; k < how.corners.size(); ++k)
                if (how.weights[k] != 0.0f) insert(how.corners[k], picked[body]);
        });
    }
    void addPairs(const Between& tie, const Mat3& turn, std::vector<TiedPair>& out) const
    {
        const std::size_t first = out.size();
        out.resize(first + tie.attachment->pairs.size());
        std::vector<double> compliance(tie.attachment->pairs.size()), yielded(compliance.size());
        forEachNode(tie, [&](std::size_t pair, std::size_t body, const NodeWeight& each) {
            const MatrixFreeSystem& system = *bodies_[body]->system.matrixFree;
            const bool to = bodies_[body] == tie.sides[1];
            const double own = system.compliance(each.node);
            compliance[pair] += each.weight * each.weight * own;
            yielded[pair] += shares_[body][static_cast<std::size_t>(each.node)] * std::abs(each.weight) * own;
            const linalg::Interpolation how = system.coarseWeights(each.node);
            for (std::size_t k = 0; k < how.corners.size(); ++k)
                if (how.weights[k] != 0.0f)
                    add(numberOf(body, how.corners[k]),
                        each.weight * static_cast<double>(how.weights[k]) * (to ? -1.0 * turn : Mat3::identity()),
                        out[first + pair]);
        });
        for (std::size_t p = 0; p < compliance.size(); ++p) {
            const bool hard = tie.attachment->stiffness == physics::kHard;
            const double sigma = hard ? Kappa{}.holding / compliance[p] : dt_ * dt_ * tie.attachment->stiffness;
            if (compliance[p] > 0.0) out[first + p].stiffness = sigma / (1.0 + sigma * yielded[p]);
        }
    }

private:
    /// Calls use(pair, body, node) for the free nodes of both sides.
    template <class Use> void forEachNode(const Between& tie, const Use& use) const
    {
        for (std::size_t side = 0; side < 2; ++side) {
            const auto body = static_cast<std::size_t>(std::ranges::find(bodies_, tie.sides[side]) - bodies_.begin());
            for (std::size_t pair = 0; pair < tie.attachment->pairs.size(); ++pair)
                for (const NodeWeight& each : tie.attachment->pairs[pair][side].nodes)
                    if (isFree(*bodies_[body], each)) use(pair, body, each);
        }
    }
    static void insert(int node, std::vector<int>& nodes)
    {
        const auto at = std::ranges::lower_bound(nodes, node);
        if (at == nodes.end() || *at != node) nodes.insert(at, node);
    }
    static void add(std::size_t node, const Mat3& g, TiedPair& pair)
    {
        const auto found = std::ranges::find(pair.parts, node, &TiedPair::Part::node);
        if (found == pair.parts.end())
            pair.parts.push_back({node, g});
        else
            found->g += g;
    }
    [[nodiscard]] std::size_t numberOf(std::size_t body, int node) const
    {
        std::size_t number =
            static_cast<std::size_t>(std::ranges::lower_bound(picked[body], node) - picked[body].begin());
        for (std::size_t b = 0; b < body; ++b) number += picked[b].size();
        return number;
    }

    double dt_;
    std::vector<const SoftBody*> bodies_;
    std::vector<std::vector<double>> shares_; ///< per body and node: the sum of the weights of all pairs
};

/// Null if it cannot be made.
std::shared_ptr<const TiedCoarse> tieGroup(double dt, std::span<const SoftBody* const> bodies,
                                           std::span<const Between> ties, std::span<const Ties::Made> made)
{
    TieBuilder builder(dt, bodies);
    for (const Between& tie : ties)
        if (builder.has(tie)) builder.count(tie);
    std::vector<TiedPair> pairs;
    for (std::size_t i = 0; i < ties.size(); ++i)
        if (builder.has(ties[i])) builder.addPairs(ties[i], made[i].turn, pairs);
    const auto coarse = std::make_shared<TiedCoarse>();
    const std::vector<std::vector<int>> picked = builder.picked;
    const auto inverse = [&](std::size_t body, std::size_t i, std::size_t k) {
        const auto unknown = [&](std::size_t of) {
            return 3 * static_cast<std::size_t>(picked[body][of / 3]) + of % 3;
        };
        return bodies[body]->system.matrixFree->coarseCompliance(unknown(i), unknown(k));
    };
    return coarse->build(picked, pairs, inverse) ? coarse : nullptr;
}

void makeTies(double dt, std::span<const Between> between, Scene& scene)
{
    scene.ties = {};
    for (const Between& each : between)
        scene.ties.made.push_back({each.attachment->id, each.attachment->pairs.size(), turnOf(each)});
    for (const std::vector<const SoftBody*>& group : groupsOf(between)) {
        TiedBodies tied{{}, tieGroup(dt, group, between, scene.ties.made)};
        for (std::size_t i = 0; i < between.size(); ++i)
            if (std::ranges::count(group, between[i].sides[0]) > 0) scene.ties.made[i].tied = tied.coarse != nullptr;
        for (const SoftBody* body : group) {
            body->system.matrixFree->tie();
            tied.bodies.push_back(body->model.id);
        }
        if (tied.coarse) scene.ties.groups.push_back(std::move(tied));
    }
}

} // namespace

void tieBodies(double dt, Scene& scene, Coupling& coupling)
{
    if (dt == 0.0) return;
    const std::vector<Between> between = attachmentsBetween(scene);
    if (!stillServe(scene, between)) makeTies(dt, between, scene);
    auto weld = coupling.constraints.begin() + static_cast<std::ptrdiff_t>(coupling.contactCount);
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        const auto made = std::ranges::find(scene.ties.made, scene.attachments[a].id, &Ties::Made::attachment);
        const bool tied = made != scene.ties.made.end() && made->tied;
        for (std::size_t p = 0; p < scene.attachmentForces[a].size(); ++p) (weld++)->tied = tied;
    }
}

} // namespace filasofia::engine
