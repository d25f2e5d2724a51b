#include "filasofia/surface/film.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace filasofia::surface {
namespace {

/// Triangles by the squares of a horizontal grid that they may cover, seen from above.
class Plan {
public:
    Plan(const FilmTopology& topology, std::span<const Vec3> positions, Vec3 up) : topology_(topology)
    {
        const Vec3 east = normalized(std::abs(up.x) < 0.9 ? cross(up, Vec3{1, 0, 0}) : cross(up, Vec3{0, 1, 0}));
        const Vec3 north = cross(up, east);
        for (const Vec3& p : positions) at_.push_back({dot(east, p), dot(north, p), dot(up, p)});
        low_ = high_ = at_.front();
        for (const Vec3& p : at_) low_ = min(low_, p), high_ = max(high_, p);
        // As many squares as triangles, more or less.
        side_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(topology.triangles.size()))));
        fill();
    }

    /// The vertex nearest to where a drop from vertex v lands, or kPast.
    [[nodiscard]] int below(int v) const
    {
        const Vec3 from = at_[v];
        const int square = squareOf(from.y, low_.y, high_.y) * side_ + squareOf(from.x, low_.x, high_.x);
        double highest = -std::numeric_limits<double>::infinity();
        int landing = FilmGeometry::kPast;
        for (int i = first_[square]; i < first_[square + 1]; ++i) {
            const geometry::Triangle& t = topology_.triangles[held_[i]];
            if (t[0] == v || t[1] == v || t[2] == v) continue;
            const auto weights = weightsAt(t, from);
            if (!weights) continue;
            const auto& [a, b, c] = *weights;
            const double height = a * at_[t[0]].z + b * at_[t[1]].z + c * at_[t[2]].z;
            if (height >= from.z || height <= highest) continue;
            highest = height;
            landing = a >= b && a >= c ? t[0] : b >= c ? t[1] : t[2];
        }
        return landing;
    }

private:
    [[nodiscard]] int squareOf(double x, double low, double high) const
    {
        return high > low ? std::clamp(static_cast<int>((x - low) / (high - low) * side_), 0, side_ - 1) : 0;
    }
    template <class Visit> void forEachSquare(const geometry::Triangle& t, const Visit& visit) const
    {
        const Vec3 low = min(min(at_[t[0]], at_[t[1]]), at_[t[2]]), high = max(max(at_[t[0]], at_[t[1]]), at_[t[2]]);
        const int right = squareOf(high.x, low_.x, high_.x), top = squareOf(high.y, low_.y, high_.y);
        for (int j = squareOf(low.y, low_.y, high_.y); j <= top; ++j)
            for (int i = squareOf(low.x, low_.x, high_.x); i <= right; ++i) visit(j * side_ + i);
    }
    void fill()
    {
        first_.assign(static_cast<std::size_t>(side_) * side_ + 1, 0);
        for (const geometry::Triangle& t : topology_.triangles)
            forEachSquare(t, [&](int square) { ++first_[square + 1]; });
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        held_.resize(first_.back());
        std::vector<int> next = first_;
        for (std::size_t t = 0; t < topology_.triangles.size(); ++t)
            forEachSquare(topology_.triangles[t], [&](int square) { held_[next[square]++] = static_cast<int>(t); });
    }
    /// Barycentric weights of a place seen from above, if it is in a triangle that faces up.
    [[nodiscard]] std::optional<std::array<double, 3>> weightsAt(const geometry::Triangle& t, Vec3 p) const
    {
        const auto twice = [](Vec3 a, Vec3 b, Vec3 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); };
        const Vec3 &a = at_[t[0]], &b = at_[t[1]], &c = at_[t[2]];
        const double all = twice(a, b, c), u = twice(p, b, c), v = twice(a, p, c), w = twice(a, b, p);
        if (!(all > 0.0) || u < 0.0 || v < 0.0 || w < 0.0) return std::nullopt;
        return std::array{u / all, v / all, w / all};
    }

    const FilmTopology& topology_;
    std::vector<Vec3> at_; ///< [m] east, north and up of each vertex
    Vec3 low_ = {}, high_ = {};
    int side_ = 1;           ///< squares along each side
    std::vector<int> first_; ///< per square, where its triangles begin in held_
    std::vector<int> held_;
};

} // namespace

void findLandings(const FilmTopology& topology, std::span<const Vec3> positions, Vec3 gravity,
                  const FilmContent& content, FilmGeometry& out)
{
    out.landing.assign(positions.size(), FilmGeometry::kUnknown);
    if (length(gravity) == 0.0) return;
    std::optional<Plan> plan;
    for (int v = 0; v < topology.vertices(); ++v) {
        if (content.volume[v] <= 0.0 || !(out.upward[v] < 0.0 || out.rim[v] > 0.0)) continue;
        if (!plan) plan.emplace(topology, positions, normalized(-gravity));
        out.landing[v] = plan->below(v);
    }
}

} // namespace filasofia::surface
