#include "filasofia/engine/topology/follow_edit.h"

#include "filasofia/engine/body/elements.h"

#include <algorithm>
#include <functional>
#include <utility>

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
            const geometry::Tetrahedron old = nodes(changed.tetrahedron);
            for (int node : nodesOf(old)) reached_.push_back(node);
        }
        std::ranges::sort(reached_);
    }

    [[nodiscard]] bool reached(int node) const { return std::ranges::binary_search(reached_, node); }

    /// The first element that has all of these nodes; -1 if there is none.
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
    [[nodiscard]] geometry::Tetrahedron nodes(int element) const
    {
        return elementNodes(model_, static_cast<std::size_t>(element));
    }

private:
    [[nodiscard]] std::size_t count() const { return elementCount(model_); }

    const MeshTopology& mesh_;
    const SoftModel& model_;
    std::vector<int> changed_, reached_;
};

/// The points that an edit reaches, each with a function that receives its new nodes and weights.
class Riders {
public:
    explicit Riders(const OldElements& before) : before_(before) {}

    /// `tell` receives the new nodes and weights. A point that spans several elements keeps its nodes.
    template <class Tell> void add(std::span<const NodeWeight> point, Tell tell)
    {
        std::vector<int> nodes;
        for (const NodeWeight& each : point)
            if (each.weight != 0.0) nodes.push_back(each.node);
        if (std::ranges::none_of(nodes, [&](int node) { return before_.reached(node); })) return;
        EmbeddedPoint embedded{.tetrahedron = before_.with(nodes), .weights = {}};
        if (embedded.tetrahedron < 0) return;
        for (const NodeWeight& each : point)
            if (const int place = placeOf(before_.nodes(embedded.tetrahedron), each.node); place >= 0)
                embedded.weights[static_cast<std::size_t>(place)] += each.weight;
        points_.push_back(embedded);
        tell_.emplace_back(std::move(tell));
    }

    void follow(const TopologyEdit& edit, const EditableMesh& mesh, const SoftModel& model)
    {
        if (points_.empty()) return;
        std::vector<geometry::Tetrahedron> tetrahedra;
        for (std::size_t e = 0; e < elementCount(model); ++e) tetrahedra.push_back(elementNodes(model, e));
        std::vector<Vec3> rest = model.rest;
        frame::followPoints(edit, tetrahedra, rest, points_);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            std::vector<NodeWeight> now;
            for (std::size_t k = 0; k < 4; ++k)
                if (const double weight = points_[i].weights[k]; weight != 0.0)
                    now.push_back(
                        {mesh.data().tetrahedra[static_cast<std::size_t>(points_[i].tetrahedron)][k], weight});
            tell_[i](now);
        }
    }

private:
    const OldElements& before_;
    std::vector<EmbeddedPoint> points_;
    std::vector<std::function<void(const std::vector<NodeWeight>&)>> tell_;
};

void addEmbedding(geometry::Embedding& embedding, Riders& riders)
{
    for (std::size_t i = 0; i < embedding.nodes.size(); ++i) {
        std::array<NodeWeight, 4> point{};
        for (std::size_t k = 0; k < 4; ++k) point[k] = {embedding.nodes[i][k], embedding.weights[i][k]};
        riders.add(point, [&embedding, i](const std::vector<NodeWeight>& now) {
            embedding.nodes[i].fill(now.front().node);
            embedding.weights[i].fill(0.0);
            for (std::size_t k = 0; k < now.size(); ++k) {
                embedding.nodes[i][k] = now[k].node;
                embedding.weights[i][k] = now[k].weight;
            }
        });
    }
}

} // namespace

void followRiders(const TopologyEdit& edit, const EditableMesh& mesh, SoftModel& soft, std::vector<Clip>& clips,
                  std::vector<Attachment>& attachments, std::vector<Channel>& channels)
{
    const OldElements before(edit, mesh, soft);
    Riders riders(before);
    const auto addPoint = [&](std::vector<NodeWeight>& point) {
        riders.add(point, [&point](const std::vector<NodeWeight>& now) { point = now; });
    };
    for (Attachment& attachment : attachments)
        for (auto& pair : attachment.pairs) {
            if (attachment.body == soft.id) addPoint(pair[0].nodes);
            if (attachment.to == soft.id) addPoint(pair[1].nodes);
        }
    for (Clip& clip : clips)
        for (ClipPair& pair : clip.pairs)
            for (std::vector<NodeWeight>& point : pair) addPoint(point);
    for (Channel& channel : channels) {
        if (channel.tissue != soft.id) continue;
        for (ChannelPoint& point : channel.points) addPoint(point.nodes);
        addPoint(channel.end);
    }
    for (CollisionModel& collision : soft.collision)
        if (!collision.own) addEmbedding(collision.embedding, riders);
    riders.follow(edit, mesh, soft);
}

} // namespace filasofia::engine
