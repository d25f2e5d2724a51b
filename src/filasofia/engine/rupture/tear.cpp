#include "filasofia/engine/rupture/tear.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/sorted.h"
#include "filasofia/engine/rupture/stress.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// Decides which elements at a node lie ahead of it.
class Parting {
public:
    Parting(const MeshTopology& mesh, int node, Vec3 direction) : mesh_(mesh), node_(node)
    {
        for (int t : mesh.around[node]) {
            const Vec3 centre = middleOf(mesh.tetrahedra[t], mesh.current);
            ahead_.push_back(dot(direction, centre - mesh.current[node]) >= 0.0 ? 1 : 0);
        }
        keepDebris();
    }

    /// True if the face is at the node and lies between the two sides.
    [[nodiscard]] bool parts(int place, int face) const
    {
        const int t = star()[place], other = mesh_.neighbours[t][face];
        if (other < 0 || mesh_.tetrahedra[t][face] == node_) return false;
        const auto at = std::ranges::find(star(), other);
        return ahead_[place] != ahead_[at - star().begin()];
    }

private:
    [[nodiscard]] const std::vector<int>& star() const { return mesh_.around[node_]; }

    /// An element that the tear would detach on its own joins the other side.
    void keepDebris()
    {
        for (int round = 0; round < 4; ++round) {
            bool changed = false;
            for (int i = 0; i < static_cast<int>(star().size()); ++i) {
                const int t = star()[i];
                int inside = 0, kept = 0;
                for (int f = 0; f < 4; ++f) {
                    if (mesh_.neighbours[t][f] < 0) continue;
                    ++inside;
                    kept += (mesh_.flagged[t] >> f & 1) != 0 || parts(i, f) ? 0 : 1;
                }
                if (inside == 0 || kept > 0) continue;
                ahead_[i] ^= 1;
                changed = true;
            }
            if (!changed) return;
        }
    }

    const MeshTopology& mesh_;
    int node_;
    std::vector<char> ahead_; ///< in the order of the node's elements
};

} // namespace

bool tearAt(EditableMesh& mesh, int node, Vec3 direction, RuptureReport& report)
{
    const MeshTopology& data = mesh.data();
    const Parting parting(data, node, direction);
    std::vector<int> candidates;
    std::vector<std::array<int, 2>> faces;
    for (int i = 0; i < static_cast<int>(data.around[node].size()); ++i)
        for (int f = 0; f < 4; ++f) {
            const int t = data.around[node][i];
            if ((data.flagged[t] >> f & 1) != 0 || !parting.parts(i, f)) continue;
            mesh.setFlagged(t, f, true);
            ++report.flagged;
            faces.push_back({t, f});
            forEachFaceNode(data.tetrahedra[t], f, [&](int n) { candidates.push_back(n); });
        }
    const long before = report.copies;
    openFaces(mesh, {.bisect = false}, std::move(candidates), report);
    // A tear opens completely or not at all: faces left flagged would disturb a later cut.
    for (auto [t, f] : faces) {
        mesh.setFlagged(t, f, false);
        mesh.setDeferred(t, f, false);
    }
    if (report.copies > before) return true;
    ++report.refused[static_cast<int>(RuptureRefusal::TearClosed)];
    return false;
}

void Tearing::findCandidates(const EditableMesh& mesh, std::span<const Mat3> stresses,
                             std::span<const std::uint8_t> held, double threshold)
{
    const MeshTopology& data = mesh.data();
    const auto mayTear = [&](int node) {
        return (held.empty() || held[node] == 0) && notBefore_[node] <= step_ && data.around[node].size() >= 2;
    };
    std::vector<std::pair<double, int>> above; // negated stress, and element
    for (int t = 0; t < mesh.tetrahedra(); ++t) {
        if (!(principalStressBound(stresses[t]) > threshold)) continue;
        const double stress = principalStress(stresses[t]).value;
        if (stress > threshold && std::ranges::any_of(nodesOf(data.tetrahedra[t]), mayTear))
            above.emplace_back(-stress, t);
    }
    // A step tears only a few nodes: if many elements are above the threshold, those of the highest stress are enough.
    constexpr std::size_t kMaxElements = 256;
    if (above.size() > kMaxElements) {
        std::ranges::nth_element(above, above.begin() + kMaxElements);
        above.resize(kMaxElements);
    }
    std::vector<int> nodes;
    for (const auto& [stress, t] : above)
        for (int n : nodesOf(data.tetrahedra[t])) nodes.push_back(n);
    sortUnique(nodes);
    candidates_.clear();
    for (int node : nodes) {
        if (!mayTear(node)) continue;
        Mat3 sum;
        double volume = 0.0;
        for (int t : data.around[node]) {
            const double v = restVolume(data, t);
            sum += v * stresses[t];
            volume += v;
        }
        const PrincipalStress mean = principalStress((1.0 / volume) * sum);
        candidates_.push_back({node, mean.value, data.current[node], mean.direction});
    }
    std::ranges::sort(candidates_, [](const Tear& a, const Tear& b) {
        return a.stress != b.stress ? a.stress > b.stress : a.node < b.node;
    });
}

RuptureReport Tearing::step(EditableMesh& mesh, std::span<const Mat3> stresses, std::span<const std::uint8_t> held,
                            const TearParameters& parameters)
{
    FILASOFIA_ASSERT(static_cast<int>(stresses.size()) == mesh.tetrahedra());
    FILASOFIA_ASSERT(held.empty() || static_cast<int>(held.size()) == mesh.nodes());
    RuptureReport report;
    torn_.clear();
    ++step_;
    notBefore_.resize(mesh.nodes(), 0);
    findCandidates(mesh, stresses, held, parameters.threshold);
    std::vector<int> touched;
    for (const Tear& candidate : candidates_) {
        // A node whose elements are all on one side costs nothing and does not count as an attempt.
        if (static_cast<int>(torn_.size()) >= parameters.maxTears || report.edits >= parameters.maxTries) break;
        const std::vector<int> star = mesh.data().around[candidate.node];
        if (std::ranges::any_of(star, [&](int t) { return std::ranges::find(touched, t) != touched.end(); })) continue;
        if (!tearAt(mesh, candidate.node, candidate.direction, report)) {
            notBefore_[candidate.node] = step_ + parameters.patience;
            continue;
        }
        torn_.push_back(candidate);
        touched.insert(touched.end(), star.begin(), star.end());
    }
    // An opening changes what its neighbours can do.
    if (!torn_.empty()) notBefore_.assign(mesh.nodes(), 0);
    return report;
}

} // namespace filasofia::engine
