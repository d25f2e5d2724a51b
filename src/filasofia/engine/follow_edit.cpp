#include "filasofia/engine/follow_edit.h"

#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

using frame::EmbeddedPoint;
using frame::TopologyEdit;

/// Finds the elements that points ride on, as they were before an edit.
class OldElements {
public:
    OldElements(const TopologyEdit& edit, const EditableMesh& mesh, const SoftModel& model)
        : mesh_(mesh.data()), model_(model)
    {
        for (const frame::TetNodes& changed : edit.changed) {
            if (static_cast<std::size_t>(changed.tetrahedron) >= count()) continue;
            changed_.push_back(changed.tetrahedron);
            for (int node : nodes(changed.tetrahedron)) reached_.push_back(node);
        }
        std::ranges::sort(reached_);
    }

    [[nodiscard]] bool reached(int node) const { return std::ranges::binary_search(reached_, node); }

    /// The first element that has all of the nodes; none: -1.
    template <class Nodes> [[nodiscard]] int with(const Nodes& wanted) const
    {
        const auto has = [&](int element) {
            return std::ranges::all_of(wanted, [&](int node) { return placeOf(nodes(element), node) >= 0; });
        };
        int found = -1;
        const auto look = [&](int element) {
            if (static_cast<std::size_t>(element) < count() && (found < 0 || element < found) && has(element))
                found = element;
        };
        for (int element : changed_) look(element);
        for (int element : mesh_.around[static_cast<std::size_t>(*std::begin(wanted))]) look(element);
        return found;
    }
    [[nodiscard]] const geometry::Tetrahedron& nodes(int element) const
    {
        const auto e = static_cast<std::size_t>(element);
        return model_.elements.empty() ? model_.tetrahedra[e] : model_.elements[e].nodes;
    }

private:
    [[nodiscard]] std::size_t count() const { return model_.elements.size() + model_.tetrahedra.size(); }

    const MeshTopology& mesh_;
    const SoftModel& model_;
    std::vector<int> changed_, reached_;
};

/// A point's nodes and weights after the edit; false where it stays as it is.
bool follow(const TopologyEdit& edit, const OldElements& before, const EditableMesh& mesh, std::vector<int>& nodes,
            std::vector<double>& weights)
{
    if (nodes.empty() || std::ranges::none_of(nodes, [&](int node) { return before.reached(node); })) return false;
    EmbeddedPoint point{.tetrahedron = before.with(nodes), .weights = {}};
    if (point.tetrahedron < 0) return false; // spread over several elements: it stays with the nodes it has
    for (std::size_t k = 0; k < nodes.size(); ++k)
        point.weights[static_cast<std::size_t>(placeOf(before.nodes(point.tetrahedron), nodes[k]))] += weights[k];
    frame::followPoints(edit, std::span(&point, 1));
    nodes.clear();
    weights.clear();
    for (std::size_t k = 0; k < 4; ++k) {
        if (point.weights[k] == 0.0) continue;
        nodes.push_back(mesh.data().tetrahedra[static_cast<std::size_t>(point.tetrahedron)][k]);
        weights.push_back(point.weights[k]);
    }
    return true;
}

void follow(const TopologyEdit& edit, const OldElements& before, const EditableMesh& mesh, AttachedPoint& point)
{
    std::vector<int> nodes;
    std::vector<double> weights;
    for (const NodeWeight& each : point.nodes) {
        nodes.push_back(each.node);
        weights.push_back(each.weight);
    }
    if (!follow(edit, before, mesh, nodes, weights)) return;
    point.nodes.clear();
    for (std::size_t k = 0; k < nodes.size(); ++k) point.nodes.push_back({nodes[k], weights[k]});
}

void follow(const TopologyEdit& edit, const OldElements& before, const EditableMesh& mesh, geometry::Embedding& ties)
{
    for (std::size_t i = 0; i < ties.nodes.size(); ++i) {
        std::vector<int> nodes;
        std::vector<double> weights;
        for (std::size_t k = 0; k < 4; ++k)
            if (ties.weights[i][k] != 0.0) {
                nodes.push_back(ties.nodes[i][k]);
                weights.push_back(ties.weights[i][k]);
            }
        if (!follow(edit, before, mesh, nodes, weights)) continue;
        ties.nodes[i].fill(nodes.front());
        ties.weights[i].fill(0.0);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            ties.nodes[i][k] = nodes[k];
            ties.weights[i][k] = weights[k];
        }
    }
}

} // namespace

void followRiders(const TopologyEdit& edit, const EditableMesh& mesh, SoftModel& soft,
                  std::vector<Attachment>& attachments)
{
    const OldElements before(edit, mesh, soft);
    for (Attachment& attachment : attachments)
        for (auto& pair : attachment.pairs) {
            if (attachment.body == soft.id) follow(edit, before, mesh, pair[0]);
            if (attachment.to == soft.id) follow(edit, before, mesh, pair[1]);
        }
    for (CollisionModel& collision : soft.collision)
        if (collision.behind.empty()) follow(edit, before, mesh, collision.ties);
}

} // namespace filasofia::engine
