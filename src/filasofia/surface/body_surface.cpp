#include "filasofia/surface/body_surface.h"

#include <algorithm>

namespace filasofia::surface {

BodySurface::Change BodySurface::set(std::vector<geometry::Triangle> triangles)
{
    const std::vector<int> before = std::move(nodes_);
    nodes_.clear();
    for (const geometry::Triangle& each : triangles) nodes_.insert(nodes_.end(), each.begin(), each.end());
    std::ranges::sort(nodes_);
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    std::vector<int> local(static_cast<std::size_t>(nodesNeeded()), -1);
    for (std::size_t v = 0; v < nodes_.size(); ++v) local[nodes_[v]] = static_cast<int>(v);
    for (geometry::Triangle& each : triangles)
        for (int& node : each) node = local[node];
    topology_ = filmTopology(static_cast<int>(nodes_.size()), std::move(triangles));

    Change change;
    std::vector<std::uint8_t> known(nodes_.size(), 0);
    for (const int node : before) {
        change.now.push_back(node < std::ssize(local) ? local[node] : -1);
        if (change.now.back() >= 0) known[change.now.back()] = 1;
    }
    for (std::size_t v = 0; v < known.size(); ++v)
        if (known[v] == 0) change.fresh.push_back(static_cast<int>(v));
    return change;
}

void BodySurface::gather(std::span<const Vec3> positions, std::vector<Vec3>& places) const
{
    places.resize(nodes_.size());
    for (std::size_t v = 0; v < nodes_.size(); ++v) places[v] = positions[static_cast<std::size_t>(nodes_[v])];
}

std::vector<float> BodySurface::byNode(std::span<const double> values) const
{
    std::vector<float> out(static_cast<std::size_t>(nodesNeeded()), kNoSurface);
    for (std::size_t v = 0; v < nodes_.size(); ++v)
        out[static_cast<std::size_t>(nodes_[v])] = static_cast<float>(values[v]);
    return out;
}

} // namespace filasofia::surface
