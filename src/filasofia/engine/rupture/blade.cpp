#include "filasofia/engine/rupture/blade.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

using geometry::Box;

constexpr double kNoLength = 1e-9;   ///< [-] fraction of the body's diagonal
constexpr double kAlongBlade = 1e-9; ///< [-] tolerance beyond a segment's ends, so that neighbours overlap
constexpr double kAlongEdge = 0.02;  ///< [-] tolerance beyond an edge's ends, so that grazed nodes are not missed
constexpr double kClearWay = 0.02;   ///< [-] fraction of the mean edge: a longer step defines the direction by itself
constexpr double kMemory = 0.1;      ///< [-] fraction of the mean edge: distance over which the direction is averaged
constexpr double kWithin = 0.02;     ///< [-] sine of the angle below which an edge lies within the surface
constexpr double kBent = 0.9;        ///< [-] cosine: a bend of less than 25 degrees is taken for a round blade
constexpr int kHalvings = 40;        ///< bisections of the time of a crossing
constexpr int kRefreshSteps = 20;    ///< steps that the list of edges lasts at the present speed

double spanned(Vec3 a, Vec3 b, Vec3 q, Vec3 r) { return dot(cross(b - a, q - a), r - a); }
Vec3 mix(Vec3 a, Vec3 b, double t) { return (1.0 - t) * a + t * b; }

double travel(std::span<const BladeSegment> blade)
{
    double longest = 0.0;
    for (const BladeSegment& s : blade)
        longest = std::max({longest, distance(s.from, s.fromBefore), distance(s.to, s.toBefore)});
    return longest;
}

/// Finds the nearest points of two lines, as parameters of p + s d and q + t e. Returns false if the lines are
/// parallel.
bool closest(Vec3 p, Vec3 d, Vec3 q, Vec3 e, double& s, double& t)
{
    const Vec3 r = p - q;
    const double a = dot(d, d), b = dot(d, e), c = dot(e, e), f = dot(d, r), g = dot(e, r), den = a * c - b * b;
    if (!(den > 1e-12 * a * c)) return false;
    s = (b * g - c * f) / den;
    t = (a * g - b * f) / den;
    return true;
}

double squaredSegmentDistance(Vec3 p, Vec3 d, Vec3 q, Vec3 e)
{
    const double a = dot(d, d), c = dot(e, e);
    double s = 0.0, t = 0.0;
    if (!closest(p, d, q, e, s, t)) s = 0.0;
    s = std::clamp(s, 0.0, 1.0);
    const auto nearestOn = [](double along, double squared) {
        return squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
    };
    t = nearestOn(dot(e, p + s * d - q), c);
    s = nearestOn(dot(d, q + t * e - p), a);
    t = nearestOn(dot(e, p + s * d - q), c);
    return lengthSquared(p + s * d - q - t * e);
}

/// n_rest ~ F^T n over the edge's elements: the normal of a surface in the tissue at rest. That of a cut
/// through a sheet leans as the blade does: all around a closed shell its side tells one half from the other.
Vec3 normalAtRest(const MeshTopology& mesh, const std::vector<int>& star, Vec3 n)
{
    Vec3 sum;
    for (int t : star) {
        const std::array<Vec3, 4> p = solidCorners(mesh.tetrahedra[t], mesh.rest),
                                  x = solidCorners(mesh.tetrahedra[t], mesh.current);
        const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], e3 = p[3] - p[0];
        const double det = dot(e1, cross(e2, e3));
        sum += (1.0 / det) * (dot(x[1] - x[0], n) * cross(e2, e3) + dot(x[2] - x[0], n) * cross(e3, e1) +
                              dot(x[3] - x[0], n) * cross(e1, e2));
    }
    return normalized(sum);
}

/// Normal of the surface that the segment cuts, at the parameter u along it and the fraction t of the step, in tissue
/// that moves by `tissue`. If the segment hardly moves in this step, its recent direction of motion is used.
Vec3 normalOf(const BladeSegment& s, Vec3 recently, double t, double u, Vec3 tissue, double meanEdge)
{
    const Vec3 along = mix(s.toBefore, s.to, t) - mix(s.fromBefore, s.from, t);
    const Vec3 way = mix(s.from - s.fromBefore, s.to - s.toBefore, u) - tissue;
    const Vec3 now = cross(along, way), before = cross(along, recently);
    const bool clear = length(now) >= kClearWay * meanEdge * length(along);
    if (!clear && length(now) < length(before)) return normalized(before);
    return normalized(dot(now, before) < 0.0 ? -now : now);
}

/// The time and place at which one edge crosses one segment during one step.
struct EdgeHit {
    double t = 0.0; ///< [-] fraction of the step
    double s = 0.0; ///< [-] parameter along the edge
    double u = 0.0; ///< [-] parameter along the segment
};

struct Sweep {
    Vec3 a0, a1, b0, b1; ///< the edge's ends before and after the step
    Vec3 q0, q1, r0, r1; ///< the segment's ends before and after the step

    [[nodiscard]] double at(double t) const
    {
        return spanned(mix(a0, a1, t), mix(b0, b1, t), mix(q0, q1, t), mix(r0, r1, t));
    }

    /// `alongEdge` [-]: tolerance beyond the edge's ends.
    std::optional<EdgeHit> findHit(int parts, double alongEdge = kAlongEdge) const
    {
        double low = 0.0, before = at(0.0);
        for (int part = 1; part <= parts; ++part) {
            const double high = part == parts ? 1.0 : static_cast<double>(part) / parts, now = at(high);
            if ((before >= 0.0) != (now >= 0.0))
                if (const auto found = findHitWithin(low, high, before >= 0.0, alongEdge)) return found;
            low = high;
            before = now;
        }
        return std::nullopt;
    }

private:
    [[nodiscard]] std::optional<EdgeHit> findHitWithin(double low, double high, bool positive, double alongEdge) const
    {
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (low + high);
            ((at(middle) >= 0.0) == positive ? low : high) = middle;
        }
        const double t = 0.5 * (low + high);
        const Vec3 a = mix(a0, a1, t), q = mix(q0, q1, t);
        EdgeHit m{t, 0.0, 0.0};
        if (!closest(a, mix(b0, b1, t) - a, q, mix(r0, r1, t) - q, m.s, m.u)) return std::nullopt;
        if (m.s < -alongEdge || m.s > 1.0 + alongEdge || m.u < -kAlongBlade || m.u > 1.0 + kAlongBlade)
            return std::nullopt;
        m.s = std::clamp(m.s, 0.0, 1.0);
        return m;
    }
};

} // namespace

std::optional<double> crossingOf(const MovingEdge& edge, const BladeSegment& segment, int parts)
{
    // Edges of a rod share their ends: with a tolerance both would be cut, and leave a node alone.
    constexpr double kAlongRod = 1e-9;
    const auto hit = Sweep{edge.aBefore,       edge.a,       edge.bBefore,     edge.b,
                           segment.fromBefore, segment.from, segment.toBefore, segment.to}
                         .findHit(parts, kAlongRod);
    return hit ? std::optional(hit->s) : std::nullopt;
}

std::optional<RuptureRefusal> refusalOf(std::span<const BladeSegment> blade, double diagonal)
{
    double longest = 0.0;
    for (const BladeSegment& s : blade) {
        if (!isFinite(s.from) || !isFinite(s.to) || !isFinite(s.fromBefore) || !isFinite(s.toBefore))
            return RuptureRefusal::BladeNotFinite;
        longest = std::max(longest, std::min(distance(s.from, s.to), distance(s.fromBefore, s.toBefore)));
    }
    if (!(longest > kNoLength * diagonal)) return RuptureRefusal::BladeNoLength;
    if (travel(blade) > diagonal) return RuptureRefusal::BladeJump;
    return std::nullopt;
}

void CrossingFinder::refresh(const EditableMesh& mesh, std::span<const BladeSegment> blade, double motion)
{
    const MeshTopology& data = mesh.data();
    const double h = mesh.meanEdge();
    margin_ = std::clamp(kRefreshSteps * motion, 0.05 * h, std::max(0.5 * h, 1.05 * motion));
    remaining_ = margin_;
    nodes_ = mesh.nodes();
    tetrahedra_ = mesh.tetrahedra();
    Box around;
    for (const BladeSegment& s : blade) around = merged(merged(around, s.from), s.to);

    // Collect the nodes that a near edge may end in, then their edges: an edge within the margin has an end within
    // margin plus its length. Lengths are known at rest only, so tissue stretched to more than twice its length may be
    // missed. An edge between two such nodes is tested from the first.
    std::vector<Box> boxes;
    for (const BladeSegment& s : blade) boxes.push_back(grown(merged(merged(Box{}, s.from), s.to), margin_));
    edges_.clear();
    seen_.resize(data.rest.size(), 0);
    near_.resize(data.rest.size(), 0);
    const long pass = ++pass_;
    for (int node = 0; node < mesh.nodes(); ++node) {
        const Vec3 x = data.current[node];
        const double radius = margin_ + mesh.reach(node);
        if (squaredDistance(around, x) > radius * radius || mesh.isGone(node)) continue;
        double nearest = radius * radius;
        for (const BladeSegment& s : blade) {
            const Vec3 d = s.to - s.from, p = x - s.from;
            const double c = dot(d, d), u = c > 0.0 ? std::clamp(dot(p, d) / c, 0.0, 1.0) : 0.0;
            nearest = std::min(nearest, lengthSquared(p - u * d));
        }
        if (!(nearest < radius * radius)) continue;
        ++stamp_;
        seen_[node] = stamp_;
        near_[node] = pass;
        const bool inside = nearest <= margin_ * margin_;
        const auto meets = [&](Vec3 end) {
            const Box box = merged(merged(Box{}, x), end);
            for (std::size_t i = 0; i < blade.size(); ++i)
                if (overlap(box, boxes[i]) &&
                    squaredSegmentDistance(x, end - x, blade[i].from, blade[i].to - blade[i].from) <= margin_ * margin_)
                    return true;
            return false;
        };
        for (int t : data.around[node])
            for (int other : nodesOf(data.tetrahedra[t])) {
                if (seen_[other] == stamp_) continue;
                seen_[other] = stamp_;
                if (near_[other] == pass) continue;
                if (inside || meets(data.current[other]))
                    edges_.push_back({std::min(node, other), std::max(node, other)});
            }
    }
    std::ranges::sort(edges_);
}

void CrossingFinder::addEdgesOfNewNodes(const EditableMesh& mesh)
{
    const MeshTopology& data = mesh.data();
    const std::size_t old = edges_.size();
    for (int node = nodes_; node < mesh.nodes(); ++node)
        for (int t : data.around[node]) {
            const geometry::Tetrahedron& n = data.tetrahedra[t];
            for (auto [i, j] : geometry::kTetrahedronEdges)
                if (n[i] != frame::kNoCorner && n[j] != frame::kNoCorner)
                    edges_.push_back({std::min(n[i], n[j]), std::max(n[i], n[j])});
        }
    if (edges_.size() == old) return;
    std::ranges::sort(edges_.begin() + static_cast<std::ptrdiff_t>(old), edges_.end());
    std::inplace_merge(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(old), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    nodes_ = mesh.nodes();
    tetrahedra_ = mesh.tetrahedra();
}

/// [m] Mean motion of the edges near the blade in the last step.
Vec3 CrossingFinder::tissueMotion(const EditableMesh& mesh) const
{
    const MeshTopology& data = mesh.data();
    Vec3 sum;
    for (auto [a, b] : edges_) sum += 0.5 * (data.current[a] - data.previous[a] + data.current[b] - data.previous[b]);
    return edges_.empty() ? sum : sum / static_cast<double>(edges_.size());
}

/// True if this step begins where the last one ended.
bool CrossingFinder::follows(const EditableMesh& mesh, std::span<const BladeSegment> blade) const
{
    return mesh.moves() - moves_ <= 1 &&
           std::ranges::equal(blade, last_, [](const BladeSegment& now, const BladeSegment& last) {
               return now.fromBefore == last.from && now.toBefore == last.to;
           });
}

/// Around a bend of the blade the normal is blended over two elements, so that neighbouring labels agree.
CrossingFinder::Normals CrossingFinder::normalsAt(std::span<const BladeSegment> blade, int segment,
                                                  std::array<double, 2> when, Vec3 tissue, double meanEdge) const
{
    const double t = when[0], u = when[1];
    const auto of = [&](int which, double along) {
        return runs_.along(which) * normalOf(blade[which], runs_.direction(which), t, along, tissue, meanEdge);
    };
    const auto alongOf = [&](int which) {
        return runs_.along(which) * normalized(blade[which].to - blade[which].from);
    };
    Normals normals{.own = of(segment, u)};
    normals.smooth = normals.own;
    const double l = distance(blade[segment].from, blade[segment].to);
    for (int end : {0, 1}) {
        const auto [next, nextEnd] = runs_.joint(segment, end);
        const double away = (end == 0 ? u : 1.0 - u) * l;
        if (next < 0 || runs_.run(next) != runs_.run(segment) || !(away < meanEdge)) continue;
        normals.smooth += (1.0 - away / meanEdge) * of(next, static_cast<double>(nextEnd));
        normals.bent = normals.bent || dot(alongOf(segment), alongOf(next)) < kBent;
    }
    normals.smooth = normalized(normals.smooth, normals.own);
    return normals;
}

void CrossingFinder::find(EditableMesh& mesh, std::span<const BladeSegment> blade, std::vector<Crossing>& crossings)
{
    const MeshTopology& data = mesh.data();
    const double h = mesh.meanEdge(), motion = travel(blade) + mesh.lastMotion();
    remaining_ -= motion;
    // After a pause or a refused step the list is invalid, and the blade may be another one.
    const bool same = follows(mesh, blade);
    if (!same) runs_.join(blade, mesh.newPass(), h);
    if (!same || !(remaining_ >= 0.0) || nodes_ != mesh.nodes() || tetrahedra_ != mesh.tetrahedra())
        refresh(mesh, blade, motion);
    moves_ = mesh.moves();
    last_.assign(blade.begin(), blade.end());
    runs_.follow(blade, tissueMotion(mesh), kMemory * h);
    const int parts = std::max(1, static_cast<int>(std::ceil(2.0 * motion / h)));
    std::vector<Box> swept;
    for (const BladeSegment& s : blade)
        swept.push_back(grown(merged(merged(merged(merged(Box{}, s.from), s.to), s.fromBefore), s.toBefore), 1e-9 * h));
    std::vector<int> star;
    for (const Edge& edge : edges_) {
        const Vec3 a0 = data.previous[edge[0]], a1 = data.current[edge[0]], b0 = data.previous[edge[1]],
                   b1 = data.current[edge[1]];
        const Box box = grown(merged(merged(merged(merged(Box{}, a0), a1), b0), b1), kAlongEdge * distance(a1, b1));
        for (std::size_t i = 0; i < blade.size(); ++i) {
            const BladeSegment& s = blade[i];
            if (!overlap(box, swept[i])) continue;
            const auto found = Sweep{a0, a1, b0, b1, s.fromBefore, s.from, s.toBefore, s.to}.findHit(parts);
            if (!found) continue;
            edgeStar(data, edge[0], edge[1], star);
            if (star.empty()) break; // this edge no longer exists
            const Vec3 tissue = mix(a1 - a0, b1 - b0, found->s);
            const auto segment = static_cast<int>(i);
            const Normals normals = normalsAt(blade, segment, {found->t, found->u}, tissue, h);
            const Vec3 e = mix(b0, b1, found->t) - mix(a0, a1, found->t);
            if (std::abs(dot(normals.own, e)) < kWithin * length(e))
                continue; // other edges at its ends are crossed instead
            Crossing c{.a = edge[0], .b = edge[1], .s = found->s};
            c.normal = normalAtRest(data, star, normals.smooth);
            c.facet = normals.bent ? normalAtRest(data, star, normals.own) : c.normal;
            c.swept = runs_.placeAt(segment, found->u, found->t);
            const Vec3 pa = data.rest[c.a], pb = data.rest[c.b];
            c.point = mix(pa, pb, c.s);
            c.length = distance(pa, pb);
            if (c.normal == Vec3{} || c.facet == Vec3{}) continue;
            if (dot(c.normal, pb - pa) < 0.0) {
                std::swap(c.a, c.b);
                c.s = 1.0 - c.s;
            }
            crossings.push_back(c);
            break;
        }
    }
}

} // namespace filasofia::engine
