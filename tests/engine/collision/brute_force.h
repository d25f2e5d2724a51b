#pragma once

#include "engine/collision/scene.h"

#include "filasofia/geometry/distance.h"

#include <map>
#include <optional>

/// A reference for findProximities(): a brute-force search over all features of all surfaces, by nearest points of
/// whole triangles and by winding numbers, without trees, signs of pseudonormals or regions. Self collision and history
/// are not covered.
namespace filasofia::engine::brute {

using Corners = std::array<int, 3>; // ascending, -1 first

struct Key {
    std::array<int, 2> surfaces;
    std::array<Corners, 2> corners;
    friend auto operator<=>(const Key&, const Key&) = default;
};
struct Answer {
    double gap;
    Vec3 normal;
    bool nearest = true; ///< false: an edge of tissue that is bent over another, and not the nearest one
};
using Answers = std::map<Key, Answer>;

inline Corners sorted(Corners corners) { return std::ranges::sort(corners), corners; }
inline bool contains(const Corners& all, const Corners& some)
{
    return std::ranges::all_of(some, [&](int v) { return v < 0 || std::ranges::find(all, v) != all.end(); });
}

// Winding number of the surface around p (van Oosterom and Strackee 1983): 1 inside, 0 outside.
inline bool isInside(const CollisionSurface& surface, Vec3 p)
{
    double angle = 0.0;
    for (const auto& [ia, ib, ic] : surface.shape->triangles) {
        const Vec3 a = surface.x[ia] - p, b = surface.x[ib] - p, c = surface.x[ic] - p;
        const double la = length(a), lb = length(b), lc = length(c);
        angle += 2.0 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return angle > 2.0 * std::numbers::pi;
}

// The features that a point can be near to: triangles in use, segments that belong to no triangle, or points.
inline std::vector<Corners> targets(const CollisionShape& shape)
{
    std::vector<Corners> all;
    if (shape.triangleFaces)
        for (const auto& t : shape.triangles) all.push_back(t);
    if (shape.triangleFaces || shape.lines)
        for (const auto& [a, b] : shape.edges) {
            const Corners line = {a, b, -1};
            const bool ofTriangle =
                std::ranges::any_of(shape.triangles, [&](const auto& t) { return contains(t, line); });
            if (!shape.triangleFaces || !ofTriangle) all.push_back(line);
        }
    else if (shape.points)
        for (int v = 0; v < static_cast<int>(shape.rest.size()); ++v) all.push_back({v, -1, -1});
    return all;
}

inline geometry::Nearest<3> nearestOn(const CollisionSurface& s, const Corners& c, Vec3 p)
{
    const auto corner = [&](int k) { return s.x[c[k] < 0 ? c[0] : c[k]]; };
    if (c[1] < 0) return {corner(0), {1, 0, 0}, lengthSquared(p - corner(0))};
    if (c[2] >= 0) return geometry::nearestOnTriangle(p, corner(0), corner(1), corner(2));
    const geometry::Nearest<2> n = geometry::nearestOnSegment(p, corner(0), corner(1));
    return {n.point, {n.weights[0], n.weights[1], 0}, n.squaredDistance};
}

inline Vec3 angleWeightedNormal(const CollisionSurface& s, int vertex)
{
    Vec3 sum;
    for (const auto& t : s.shape->triangles)
        for (int k = 0; k < 3; ++k) {
            if (t[k] != vertex) continue;
            const Vec3 a = s.x[t[(k + 1) % 3]] - s.x[vertex], b = s.x[t[(k + 2) % 3]] - s.x[vertex];
            sum += std::acos(dot(a, b) / length(a) / length(b)) * normalized(cross(a, b));
        }
    return normalized(sum);
}

inline int trianglesAt(const CollisionShape& shape, const Corners& edge)
{
    return static_cast<int>(std::ranges::count_if(shape.triangles, [&](const auto& t) { return contains(t, edge); }));
}
inline bool atRim(const CollisionShape& shape, const Corners& feature)
{
    return std::ranges::any_of(shape.edges, [&](const auto& e) {
        const Corners edge{e[0], e[1], -1};
        const bool touches = feature[1] < 0 ? contains(edge, feature) : contains(feature, edge) && feature[2] < 0;
        return touches && trianglesAt(shape, edge) == 1;
    });
}

inline bool facing(const CollisionSurface& own, int point, Vec3 towards)
{
    const CollisionShape& shape = *own.shape;
    const bool used = std::ranges::any_of(shape.triangles, [&](const auto& t) { return contains(t, {point, -1, -1}); });
    if (!shape.triangleFaces || !used || (!shape.closed && atRim(shape, {point, -1, -1}))) return true;
    const double cosine = dot(angleWeightedNormal(own, point), towards);
    double leading = -1.0;
    for (const auto& e : shape.edges)
        for (int k = 0; k < 2; ++k)
            if (e[k] == point) leading = std::max(leading, dot(normalized(own.x[e[1 - k]] - own.x[point]), towards));
    return leading <= 0.02 && (cosine > 0.0 || !shape.closed);
}

inline bool usedByAny(const CollisionShape& shape, int vertex)
{
    if (shape.edges.empty()) return true;
    return std::ranges::any_of(shape.edges, [&](const auto& e) { return e[0] == vertex || e[1] == vertex; });
}

struct Minimum {
    Corners corners;
    std::array<double, 3> weights;
    Vec3 place;
    double distance;
};

inline std::map<Corners, Minimum> minima(const CollisionSurface& target, Vec3 p)
{
    std::map<Corners, Minimum> found;
    const std::vector<Corners> all = targets(*target.shape);
    for (const Corners& t : all) {
        const geometry::Nearest<3> n = nearestOn(target, t, p);
        Corners on{-1, -1, -1};
        for (int k = 0; k < 3; ++k)
            if (n.weights[k] > 0.0) on[k] = t[k];
        const bool lowest = std::ranges::all_of(all, [&](const Corners& other) {
            return !contains(other, on) || nearestOn(target, other, p).squaredDistance > n.squaredDistance - 1e-13;
        });
        if (lowest) found[sorted(on)] = {on, n.weights, n.point, std::sqrt(n.squaredDistance)};
    }
    return found;
}

inline void meetPoints(const std::vector<CollisionSurface>& s, std::array<int, 2> pair, int source, double reach,
                       Answers& out)
{
    const CollisionSurface &own = s[static_cast<std::size_t>(pair[source])],
                           &target = s[static_cast<std::size_t>(pair[1 - source])];
    const bool solid = target.shape->closed && target.shape->triangleFaces;
    const double near = own.shape->proximity + target.shape->proximity, deep = own.shape->depth + target.shape->depth;
    for (int point = 0; point < static_cast<int>(own.x.size()); ++point) {
        if (!own.shape->points || !usedByAny(*own.shape, point)) continue;
        const Vec3 p = own.x[point];
        const std::map<Corners, Minimum> all = minima(target, p);
        const bool inside = solid && isInside(target, p);
        double least = 1e300;
        for (const auto& [corners, m] : all) least = std::min(least, m.distance);
        for (const auto& [corners, m] : all) {
            const Vec3 away = normalized(p - m.place);
            Vec3 v = own.v[point];
            for (int k = 0; k < 3; ++k)
                if (m.corners[k] >= 0) v -= m.weights[k] * target.v[m.corners[k]];
            if (inside ? m.distance > least || m.distance > deep
                       : !(m.distance < near + reach * std::max(0.0, -dot(v, away))))
                continue;
            if (!inside && solid && isInside(target, m.place + 1e-6 * away)) continue; // from behind
            if (!inside && corners[0] < 0 && !facing(own, point, -away)) continue;     // not in a face
            Key key{pair, {}};
            key.corners[source] = sorted({point, -1, -1});
            key.corners[1 - source] = corners;
            const double sign = inside ? -1.0 : 1.0;
            out.try_emplace(key, Answer{sign * m.distance, (source == 0 ? sign : -sign) * away});
        }
    }
}

/// Whether the edge is the surface's nearest feature to a place slightly off it; empty if the case is ambiguous.
inline std::optional<bool> looksAt(const CollisionSurface& s, std::array<int, 2> edge, Vec3 at, Vec3 off)
{
    if (!s.shape->triangleFaces) return true;
    bool clear = true;
    for (const auto& t : s.shape->triangles) {
        if (!contains(t, {edge[0], edge[1], -1})) continue;
        const int opposite = t[0] + t[1] + t[2] - edge[0] - edge[1];
        const Vec3 to = s.x[opposite] - at;
        if (std::fabs(dot(off, to)) < 4e-3 * length(to)) return std::nullopt;
        const auto n = geometry::nearestOnTriangle(at + 1e-3 * off, s.x[t[0]], s.x[t[1]], s.x[t[2]]);
        clear = clear && n.squaredDistance > 1e-6 * (1.0 - 1e-9);
    }
    if (clear && s.shape->closed && trianglesAt(*s.shape, {edge[0], edge[1], -1}) > 0)
        clear = !isInside(s, at + 1e-5 * off);
    return clear;
}

/// How the triangles of an edge of tissue, or of one that tissue meets, lie against a direction towards the other edge.
struct Slopes {
    bool nearly = true, away = true, sharp = false; ///< as in EdgeSlopes
    bool unsure = false;                            ///< one of the angles is at its bound
};
inline Slopes slopes(const CollisionSurface& s, std::array<int, 2> edge, Vec3 at, Vec3 off)
{
    const Corners line{edge[0], edge[1], -1};
    const int triangles = trianglesAt(*s.shape, line);
    if (!s.shape->triangleFaces || triangles == 0) return {};
    Slopes out{.away = triangles == 1 && !s.shape->closed};
    const auto over = [&](double sine, double bound) {
        out.unsure = out.unsure || std::fabs(sine - bound) < 1e-9;
        return sine > bound;
    };
    for (const auto& t : s.shape->triangles) {
        if (!contains(t, line)) continue;
        const Vec3 ends[] = {s.x[edge[0]], s.x[edge[1]]}, opposite = s.x[t[0] + t[1] + t[2] - edge[0] - edge[1]];
        const double towards = dot(off, opposite - ends[0]) / length(opposite - ends[0]);
        out.nearly = out.nearly && !over(towards, 0.1);
        out.away = out.away || over(-towards, 1e-3);
        // The angle of the triangle itself, by the angle of its normal.
        const Vec3 normal = normalized(cross(ends[1] - ends[0], opposite - ends[0]));
        const double sine = std::sqrt(std::max(0.0, 1.0 - dot(normal, off) * dot(normal, off)));
        if (towards < 0.0) out.sharp = over(sine, 0.3) || out.sharp;
    }
    if (s.shape->closed) out.nearly = out.nearly && !isInside(s, at + 1e-5 * off);
    return out;
}

/// True if the place is so near to the surface that inside and outside are ambiguous.
inline bool grazes(const CollisionSurface& s, Vec3 place, double within)
{
    return std::ranges::any_of(s.shape->triangles, [&](const auto& t) {
        return geometry::nearestOnTriangle(place, s.x[t[0]], s.x[t[1]], s.x[t[2]]).squaredDistance < within * within;
    });
}

inline void collideEdges(const std::vector<CollisionSurface>& s, std::array<int, 2> pair, double reach, Answers& out,
                         std::vector<Key>& closeCalls)
{
    const CollisionSurface &one = s[static_cast<std::size_t>(pair[0])], &two = s[static_cast<std::size_t>(pair[1])];
    if (!one.shape->lines || !two.shape->lines) return;
    const double near = one.shape->proximity + two.shape->proximity, deep = one.shape->depth + two.shape->depth;
    for (const auto& a : one.shape->edges)
        for (const auto& b : two.shape->edges) {
            // The nearest points of the two lines, by Cramer's rule on the normal equations.
            const Vec3 u = one.x[a[1]] - one.x[a[0]], v = two.x[b[1]] - two.x[b[0]], r = two.x[b[0]] - one.x[a[0]];
            const double det = dot(u, u) * dot(v, v) - dot(u, v) * dot(u, v);
            const double i = (dot(r, u) * dot(v, v) - dot(r, v) * dot(u, v)) / det;
            const double k = (dot(r, u) * dot(u, v) - dot(r, v) * dot(u, u)) / det;
            if (!(i > 0.0 && i < 1.0 && k > 0.0 && k < 1.0)) continue;
            const Vec3 pa = one.x[a[0]] + i * u, pb = two.x[b[0]] + k * v;
            const Key key{pair, {Corners{-1, a[0], a[1]}, Corners{-1, b[0], b[1]}}};
            const auto isSolid = [](const CollisionSurface& x, std::array<int, 2> e) {
                return x.shape->closed && x.shape->triangleFaces && trianglesAt(*x.shape, {e[0], e[1], -1}) > 0;
            };
            for (const double sign : {1.0, -1.0}) {
                if (sign < 0.0 && !isSolid(one, a) && !isSolid(two, b)) continue;
                const Vec3 n = sign * normalized(pa - pb);
                const auto first = looksAt(one, a, pa, -n), second = looksAt(two, b, pb, n);
                if (!first || !second) closeCalls.push_back(key);
                if (!first || !second) continue;
                const bool nearest = *first && *second, tissue = one.element < 0 || two.element < 0;
                const Slopes ofOne = slopes(one, a, pa, -n), ofTwo = slopes(two, b, pb, n);
                if (tissue && (ofOne.unsure || ofTwo.unsure)) closeCalls.push_back(key);
                const bool bent = tissue && ofOne.nearly && ofTwo.nearly &&
                                  ((ofOne.away && ofTwo.away) || ofOne.sharp || ofTwo.sharp);
                if (!nearest && !bent) continue;
                const double gap = dot(pa - pb, n);
                const Vec3 w =
                    one.v[a[0]] + i * (one.v[a[1]] - one.v[a[0]]) - two.v[b[0]] - k * (two.v[b[1]] - two.v[b[0]]);
                const double range = (nearest ? 1.0 : 0.3) * near;
                if (!(gap < range + reach * std::max(0.0, -dot(w, n))) || gap < -deep) continue;
                if (gap < 0.0 && (grazes(two, pa, 3e-3 * gap) || grazes(one, pb, 3e-3 * gap)))
                    closeCalls.push_back(key);
                if (gap < 0.0 && isSolid(two, b) && !isInside(two, pa)) continue;
                if (gap < 0.0 && isSolid(one, a) && !isInside(one, pb)) continue;
                out.try_emplace(key, Answer{gap, n, nearest});
            }
        }
}

inline Answers answers(const Scene& scene, std::vector<Key>& closeCalls)
{
    Answers out;
    const std::vector<CollisionSurface>& s = scene.surfaces;
    for (int i = 0; i < static_cast<int>(s.size()); ++i)
        for (int k = i + 1; k < static_cast<int>(s.size()); ++k) {
            if (s[i].name.body == s[k].name.body || s[i].shape->group != s[k].shape->group) continue;
            meetPoints(s, {i, k}, 0, 1.5 * scene.dt, out);
            meetPoints(s, {i, k}, 1, 1.5 * scene.dt, out);
            collideEdges(s, {i, k}, 1.5 * scene.dt, out, closeCalls);
        }
    return out;
}

} // namespace filasofia::engine::brute
