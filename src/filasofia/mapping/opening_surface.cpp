#include "filasofia/mapping/opening_surface.h"

#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/geometry/texture_seams.h"
#include "filasofia/mapping/outside.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace filasofia::mapping {
namespace {

using geometry::Triangle;

constexpr double kNearCorner =
    0.02; ///< [-] fraction of an edge: a division nearer to its end would leave a triangle without area
constexpr double kSamePlace = 1e-6; ///< [-] fraction of a mean edge: distance of points that coincide
constexpr double kLostBy =
    0.05; ///< [-] fraction of a mean edge: if the boundary is now farther by this much, the vertex has lost its anchor
constexpr double kCurved =
    0.5; ///< [-] fraction of a mean edge: how far the boundary may be from an edge of the surface
constexpr double kStrip = 0.01; ///< [-] fraction of a mean edge: a surface nearer to the rim than this needs no strip

geometry::Embedding embeddingOf(const SoftMap& map)
{
    if (const auto* barycentric = std::get_if<BarycentricMap>(&map)) return barycentric->embedding;
    geometry::Embedding embedding;
    for (const int node : std::get<IdentityMap>(map).nodes) {
        embedding.nodes.push_back({node, node, node, node});
        embedding.weights.push_back({1.0, 0.0, 0.0, 0.0});
    }
    return embedding;
}

/// A tree of the boxes of the triangles that cuts have opened.
geometry::Bvh openedTree(const frame::Boundary& boundary)
{
    std::vector<geometry::Box> boxes;
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        if (boundary.opened[t] == 0) continue;
        const auto& [a, b, c] = boundary.triangles[t];
        boxes.push_back(geometry::boxAround(std::array{boundary.rest[a], boundary.rest[b], boundary.rest[c]}));
    }
    return geometry::Bvh(boxes);
}

/// The parameter in [0, 1] along the edge from a to b where it is nearest to another edge.
double nearestShare(Vec3 a, Vec3 b, const std::array<Vec3, 2>& other)
{
    const Vec3 u = b - a, v = other[1] - other[0], w = a - other[0];
    const double uu = lengthSquared(u), vv = lengthSquared(v), uv = dot(u, v), wide = uu * vv - uv * uv;
    const double alongOther = // 0 if the other edge has no length, or both are parallel
        wide > 1e-9 * uu * vv ? std::clamp((uu * dot(v, w) - uv * dot(u, w)) / wide, 0.0, 1.0) : 0.0;
    return uu > 0.0 ? std::clamp(dot(other[0] + alongOther * v - a, u) / uu, 0.0, 1.0) : 0.5;
}

/// The division of an edge of the surface: a vertex on each side, and below it one on the rim. -1 if that side is gone.
struct Division {
    std::array<int, 2> vertex{-1, -1}; ///< first on the side of the edge's lower vertex, second of its higher one
    std::array<int, 2> rim{-1, -1};
};

/// One surface on one boundary, while it is being divided.
class Opening {
public:
    Opening(const MappedSurface& whole, const geometry::Embedding& embedding, const frame::Boundary& boundary)
        : outside_(boundary), boundary_(boundary), opened_(openedTree(boundary)),
          whole_(whole.surface), surface_{whole.surface.vertices, {}, {}}, embedding_(embedding),
          rim_(whole.surface.vertices.size(), 0)
    {
        if (!geometry::perCorner(whole_)) surface_.uv = whole_.uv; // else they are made at the end
    }

    [[nodiscard]] const Outside& outside() const { return outside_; }

    /// Whether the boundary has changed at the vertex, or may have.
    [[nodiscard]] bool touched(int vertex, const Triangle& anchor)
    {
        if (!outside_.has(anchor)) return true;
        const geometry::Tetrahedron& nodes = embedding_.nodes[vertex];
        const std::array<double, 4>& weights = embedding_.weights[vertex];
        Vec3 now;
        geometry::Box box;
        for (int k = 0; k < 4; ++k) {
            now += weights[k] * boundary_.rest[nodes[k]];
            box = merged(box, boundary_.rest[nodes[k]]);
        }
        const double margin = kSamePlace * outside_.meanEdge();
        if (distance(now, whole_.vertices[vertex]) > margin) return true;
        opened_.overlapping(grown(merged(box, whole_.vertices[vertex]), margin), found_);
        return !found_.empty();
    }

    /// From now on the vertex is embedded in the element behind the nearest triangle of the boundary.
    void anchor(int vertex, double usualDistance)
    {
        const double lost = usualDistance + kLostBy * outside_.meanEdge();
        const auto place = outside_.nearest(whole_.vertices[vertex], lost);
        touched_[vertex] = place.value_or(OutsidePlace{-1, whole_.vertices[vertex]});
        if (place) embedOn(vertex, place->triangle);
    }

    /// A triangle of the whole surface, by its number.
    void divide(std::size_t number)
    {
        const Triangle& triangle = whole_.triangles[number];
        divided_ = number;
        if (std::ranges::none_of(triangle, [&](int vertex) { return touched_.contains(vertex); })) {
            push(triangle);
            return;
        }
        std::array<const Division*, 3> across{}; // the division of the edge opposite each corner
        int crossed = 0;
        for (int k = 0; k < 3; ++k) {
            across[k] = division(triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
            crossed += across[k] != nullptr;
        }
        if (crossed == 0) return add(triangle);
        if (crossed == 1) return divideInTwo(triangle, across);
        if (crossed == 2) return cutOffCorner(triangle, across);
        divideInThree(triangle, across);
    }

    /// The result, without the vertices that no triangle uses any more.
    MappedSurface finish()
    {
        const bool seams = geometry::perCorner(whole_), printed = !surface_.uv.empty();
        std::vector<std::array<double, 2>> ofCorners = seams ? uvOfCorners() : std::vector<std::array<double, 2>>{};
        std::vector<int> fresh(surface_.vertices.size(), -1);
        for (const Triangle& triangle : surface_.triangles)
            for (const int vertex : triangle) fresh[vertex] = 0;
        int kept = 0;
        for (std::size_t v = 0; v < fresh.size(); ++v) {
            if (fresh[v] < 0) continue;
            surface_.vertices[kept] = surface_.vertices[v];
            if (printed) surface_.uv[kept] = surface_.uv[v];
            embedding_.nodes[kept] = embedding_.nodes[v];
            embedding_.weights[kept] = embedding_.weights[v];
            rim_[kept] = rim_[v];
            fresh[v] = kept++;
        }
        surface_.vertices.resize(kept);
        if (printed) surface_.uv.resize(kept);
        embedding_.nodes.resize(kept);
        embedding_.weights.resize(kept);
        rim_.resize(kept);
        for (Triangle& triangle : surface_.triangles)
            for (int& vertex : triangle) vertex = fresh[vertex];
        if (seams) geometry::setUvOfCorners(surface_, std::move(ofCorners));
        return {std::move(surface_), BarycentricMap{std::move(embedding_)}, std::move(rim_)};
    }

private:
    void push(const Triangle& triangle)
    {
        surface_.triangles.push_back(triangle);
        parents_.push_back(divided_);
    }
    /// Texture coordinates of all corners, from those of the triangles that were divided.
    [[nodiscard]] std::vector<std::array<double, 2>> uvOfCorners() const
    {
        std::vector<std::array<double, 2>> out;
        for (std::size_t t = 0; t < parents_.size(); ++t) {
            const Triangle& parent = whole_.triangles[parents_[t]];
            const auto uvAt = [&](int vertex) {
                const auto corner = std::ranges::find(parent, vertex) - parent.begin();
                return whole_.uv[3 * parents_[t] + static_cast<std::size_t>(corner)];
            };
            for (const int vertex : surface_.triangles[t]) {
                const int fresh = vertex - static_cast<int>(whole_.vertices.size());
                if (fresh < 0) {
                    out.push_back(uvAt(vertex));
                } else {
                    const auto [from, to, share] = added_[fresh];
                    out.push_back(between(uvAt(from), uvAt(to), share));
                }
            }
        }
        return out;
    }
    static std::array<double, 2> between(const std::array<double, 2>& a, const std::array<double, 2>& b, double share)
    {
        return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
    }
    void embedOn(int vertex, int triangle)
    {
        geometry::Embedding one;
        outside_.embed(surface_.vertices[vertex], triangle, one);
        embedding_.nodes[vertex] = one.nodes.front();
        embedding_.weights[vertex] = one.weights.front();
    }
    [[nodiscard]] bool gone(int vertex) const
    {
        const auto found = touched_.find(vertex);
        return found != touched_.end() && found->second.triangle < 0;
    }
    /// The position on the boundary of a vertex of the given surface.
    std::optional<OutsidePlace> placeOf(int vertex)
    {
        if (const auto found = touched_.find(vertex); found != touched_.end()) return found->second;
        return outside_.nearest(whole_.vertices[vertex], geometry::Box::kFar);
    }

    int addVertex(Vec3 place, int from, int to, double share, int triangle)
    {
        const int vertex = static_cast<int>(surface_.vertices.size());
        surface_.vertices.push_back(place);
        added_.push_back({from, to, share});
        if (!surface_.uv.empty()) surface_.uv.push_back(between(whole_.uv[from], whole_.uv[to], share));
        embedding_.nodes.emplace_back();
        embedding_.weights.emplace_back();
        rim_.push_back(0);
        embedOn(vertex, triangle);
        return vertex;
    }

    /// The division of the edge between two vertices; null if both are still connected.
    const Division* division(int from, int to)
    {
        const std::pair edge = std::minmax(from, to);
        if (const auto known = divisions_.find(edge); known != divisions_.end())
            return known->second ? &*known->second : nullptr;
        auto& made = divisions_[edge];
        made = divideEdge(edge.first, edge.second);
        return made ? &*made : nullptr;
    }
    std::optional<Division> divideEdge(int low, int high)
    {
        if (!touched_.contains(low) && !touched_.contains(high)) return std::nullopt;
        if (!gone(low) && !gone(high) && !nearOpened(low, high)) return std::nullopt;
        const std::array ends{endOf(low, high), endOf(high, low)};
        if (!ends[0] || !ends[1]) return std::nullopt;
        if (ends[0]->triangle < 0 && ends[1]->triangle < 0) return std::nullopt;
        const Vec3 a = whole_.vertices[low], b = whole_.vertices[high];
        std::array<std::optional<RimEdge>, 2> rims;
        double share = 0.0;
        int sides = 0;
        for (int side = 0; side < 2; ++side) {
            if (ends[side]->triangle < 0) continue;
            rims[side] = outside_.rimBetween(*ends[side], *ends[1 - side]);
            if (!rims[side]) return std::nullopt;
            share += nearestShare(a, b, rims[side]->ends);
            ++sides;
        }
        share = std::clamp(share / sides, kNearCorner, 1.0 - kNearCorner);
        const Vec3 place = a + share * (b - a);
        Division made;
        for (int side = 0; side < 2; ++side) {
            if (!rims[side]) continue;
            const auto& [triangle, edge] = *rims[side];
            made.vertex[side] = addVertex(place, low, high, share, triangle);
            rim_[made.vertex[side]] = 1;
            made.rim[side] =
                addVertex(geometry::nearestOnSegment(place, edge[0], edge[1]).point, low, high, share, triangle);
        }
        return made;
    }
    bool nearOpened(int low, int high)
    {
        const std::array<Vec3, 2> ends{whole_.vertices[low], whole_.vertices[high]};
        opened_.overlapping(grown(geometry::boxAround(ends), kCurved * outside_.meanEdge()), found_);
        return !found_.empty();
    }
    /// The starting point of the path from one vertex to another: if a vertex lies on a crease of the boundary, the
    /// point is on that side of the crease to which the path leads.
    std::optional<OutsidePlace> endOf(int vertex, int other)
    {
        const auto place = placeOf(vertex);
        if (!place || place->triangle < 0) return place;
        const Vec3 p = whole_.vertices[vertex];
        const auto ahead = outside_.nearest(p + kNearCorner * (whole_.vertices[other] - p), geometry::Box::kFar);
        return ahead && !outside_.rimBetween(*place, *ahead) ? ahead : place;
    }
    static std::size_t sideOf(int vertex, int other) { return vertex < other ? 0 : 1; }

    void add(const Triangle& triangle)
    {
        for (const int vertex : triangle)
            if (vertex < 0 || gone(vertex)) return;
        push(triangle);
    }
    void addQuad(int a, int b, int c, int d)
    {
        add({a, b, c});
        add({a, c, d});
    }
    /// Adds skin from the edge of the surface down to the rim; the edge goes from one division to the next with its
    /// part on the left.
    void addStrip(int from, int rimFrom, int to, int rimTo)
    {
        if (from < 0 || to < 0) return;
        const auto& places = surface_.vertices;
        const double high = std::max(distance(places[from], places[rimFrom]), distance(places[to], places[rimTo]));
        if (high > kStrip * outside_.meanEdge()) addQuad(to, from, rimFrom, rimTo);
    }

    /// One edge is divided: the opening ends in the opposite corner.
    void divideInTwo(const Triangle& triangle, const std::array<const Division*, 3>& across)
    {
        const int k = static_cast<int>(std::ranges::find_if(across, [](auto* each) { return each; }) - across.begin());
        const int tip = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
        add({tip, b, across[k]->vertex[sideOf(b, c)]});
        add({across[k]->vertex[sideOf(c, b)], c, tip});
    }
    /// Two edges are divided: the corner between them is cut off.
    void cutOffCorner(const Triangle& triangle, const std::array<const Division*, 3>& across)
    {
        const int k = static_cast<int>(std::ranges::find(across, nullptr) - across.begin());
        const int a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
        const Division &ab = *across[(k + 2) % 3], &ac = *across[(k + 1) % 3];
        const std::size_t nearAb = sideOf(a, b), nearAc = sideOf(a, c), farAb = sideOf(b, a), farAc = sideOf(c, a);
        add({a, ab.vertex[nearAb], ac.vertex[nearAc]});
        addStrip(ab.vertex[nearAb], ab.rim[nearAb], ac.vertex[nearAc], ac.rim[nearAc]);
        addQuad(ab.vertex[farAb], b, c, ac.vertex[farAc]);
        addStrip(ac.vertex[farAc], ac.rim[farAc], ab.vertex[farAb], ab.rim[farAb]);
    }
    /// All three edges are divided: each corner has its part, and the three parts join in the middle.
    void divideInThree(const Triangle& triangle, const std::array<const Division*, 3>& across)
    {
        const auto& places = surface_.vertices;
        for (int k = 0; k < 3; ++k) {
            const int a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
            const int ab = across[(k + 2) % 3]->vertex[sideOf(a, b)], ac = across[(k + 1) % 3]->vertex[sideOf(a, c)];
            if (ab < 0 || ac < 0 || gone(a)) continue;
            Vec3 middle;
            for (const Division* each : across)
                middle += (1.0 / 3.0) * places[each->vertex[each->vertex[0] < 0 ? 1 : 0]];
            const int m = addVertex(middle, b, c, 0.5, placeOf(a)->triangle);
            addQuad(a, ab, m, ac);
        }
    }

    Outside outside_;
    const frame::Boundary& boundary_;
    geometry::Bvh opened_;
    const geometry::TriangleMesh& whole_;
    geometry::TriangleMesh surface_;
    geometry::Embedding embedding_;
    /// A vertex between two of the whole surface.
    struct Added {
        int from, to;
        double share; ///< [-] as a share of the way
    };
    std::vector<Added> added_;
    std::size_t divided_ = 0;          ///< the triangle of the whole surface that is being divided
    std::vector<std::size_t> parents_; ///< per triangle: the one that it is a part of
    std::vector<std::uint8_t> rim_;    ///< per vertex, 1 on the rim
    std::unordered_map<int, OutsidePlace>
        touched_; ///< by vertex of the whole surface; triangle -1 if its piece is gone
    std::map<std::pair<int, int>, std::optional<Division>> divisions_; ///< by edge, the lower vertex first
    std::vector<int> found_;
};

} // namespace

std::shared_ptr<const OpeningSurface> OpeningSurface::make(std::shared_ptr<const MappedSurface> whole,
                                                           const geometry::TetMesh& rest)
{
    geometry::Surface skin = geometry::extractSurface(rest);
    frame::Boundary boundary{.opened = std::vector<std::uint8_t>(skin.mesh.triangles.size()), .rest = rest.nodes};
    for (Triangle triangle : skin.mesh.triangles) {
        for (int& corner : triangle) corner = skin.nodes[corner];
        boundary.triangles.push_back(triangle);
    }
    const Outside outside(boundary);
    auto made = std::make_shared<OpeningSurface>();
    for (const Vec3& vertex : whole->surface.vertices) {
        const auto place = outside.nearest(vertex, outside.meanEdge());
        if (!place) return nullptr;
        made->anchors_.push_back({outside.nodes(place->triangle), distance(vertex, place->point)});
    }
    made->embedding_ = embeddingOf(whole->map);
    made->whole_ = std::move(whole);
    return made;
}

std::shared_ptr<const MappedSurface> OpeningSurface::on(const frame::Boundary& boundary) const
{
    Opening opening(*whole_, embedding_, boundary);
    bool all = true;
    for (std::size_t v = 0; v < anchors_.size(); ++v) {
        const int vertex = static_cast<int>(v);
        if (!opening.touched(vertex, anchors_[v].nodes)) continue;
        opening.anchor(vertex, anchors_[v].distance);
        all = false;
    }
    if (all) return whole_;
    for (std::size_t t = 0; t < whole_->surface.triangles.size(); ++t) opening.divide(t);
    return std::make_shared<const MappedSurface>(opening.finish());
}

} // namespace filasofia::mapping
