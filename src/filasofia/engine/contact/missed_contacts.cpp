#include "filasofia/engine/contact/missed_contacts.h"

#include "filasofia/engine/collision/feature_pass.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr std::size_t kEdgesOfBox = 8; ///< edges whose common box is tested before theirs
constexpr double kNearer = 0.9;        ///< [-] how near lines may come in a step that is solved again, relative to now
constexpr double kCrossed = 1e-6;      ///< [-] part of the sum of the radii: lines this near to each other cross
constexpr double kMeet = 0.02;         ///< [-] part of the sum of the radii: lines this near to each other meet

struct SweptBox {
    Vec3 low, high;
};
bool apart(const SweptBox& a, const SweptBox& b)
{
    return a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y || a.low.z > b.high.z ||
           b.low.z > a.high.z;
}
SweptBox around(const SweptBox& a, const SweptBox& b) { return {min(a.low, b.low), max(a.high, b.high)}; }

/// A rod's line in the step.
struct SweptLine {
    std::size_t body = 0;
    int place = 0; ///< in the list of surfaces
    const CollisionShape* shape = nullptr;
    std::vector<MovedEdge> edges = {};
    std::vector<SweptBox> boxes = {}, groups = {};
};

SweptLine sweptLine(double dt, const SoftBody& body, std::size_t index, int place, const CollisionShape& shape)
{
    SweptLine out{.body = index, .place = place, .shape = &shape};
    const std::vector<Vec3>&x = body.state.x, &v = body.state.v, &dv = body.system.dv;
    for (const auto& [a, b] : shape.edges) {
        const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
        const MovedEdge& edge = out.edges.emplace_back(
            MovedEdge{MovedPoint{x[i], x[i] + dt * (v[i] + dv[i])}, MovedPoint{x[k], x[k] + dt * (v[k] + dv[k])}});
        const SweptBox box{min(min(edge[0].from, edge[1].from), min(edge[0].to, edge[1].to)),
                           max(max(edge[0].from, edge[1].from), max(edge[0].to, edge[1].to))};
        if (out.boxes.size() % kEdgesOfBox == 0) out.groups.push_back(box);
        out.groups.back() = around(out.groups.back(), box);
        out.boxes.push_back(box);
    }
    return out;
}

void addPass(const SweptLine& one, std::size_t i, const SweptLine& two, std::size_t k, double radii,
             std::vector<MissedContact>& out)
{
    const std::array a{one.edges[i][0].from, one.edges[i][1].from}, b{two.edges[k][0].from, two.edges[k][1].from};
    const Vec3 between = betweenEdges(a, b);
    // Lines that cross at the start, as someone may draw them, have no side to stay on: contact parts them.
    if (length(between) < kCrossed * radii) return;
    const Vec3 across = normalized(cross(a[1] - a[0], b[1] - b[0]), {0, 0, 1});
    const auto corners = [&](const SweptLine& line, std::size_t edge, const std::array<Vec3, 2>& x) {
        const auto& nodes = line.shape->edges[edge];
        return FeatureCorners{line.place, {nodes[0], nodes[1], -1}, {x[0], x[1], {}}};
    };
    addPlane(corners(one, i, a), corners(two, k, b), between, across, radii, {one.body, two.body}, out);
}

void findBetween(const SweptLine& one, const SweptLine& two, double radii, std::vector<MissedContact>& out)
{
    const bool self = &one == &two;
    const auto sharesNode = [&](std::size_t i, std::size_t k) {
        const auto &a = one.shape->edges[i], &b = two.shape->edges[k];
        return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
    };
    for (std::size_t g = 0; g < one.groups.size(); ++g)
        for (std::size_t h = self ? g : 0; h < two.groups.size(); ++h) {
            if (apart(one.groups[g], two.groups[h])) continue;
            const std::size_t lastOne = std::min(one.edges.size(), (g + 1) * kEdgesOfBox);
            const std::size_t lastTwo = std::min(two.edges.size(), (h + 1) * kEdgesOfBox);
            for (std::size_t i = g * kEdgesOfBox; i < lastOne; ++i)
                for (std::size_t k = self ? std::max(i + 1, h * kEdgesOfBox) : h * kEdgesOfBox; k < lastTwo; ++k) {
                    if (apart(one.boxes[i], two.boxes[k]) || (self && sharesNode(i, k))) continue;
                    if (firstMeeting(one.edges[i], two.edges[k], kMeet * radii)) addPass(one, i, two, k, radii, out);
                }
        }
}

/// Per surface, the velocity of a rod that moves farther than detection has looked ahead; empty: all others.
std::vector<std::vector<Vec3>> fasterThanForeseen(double dt, const std::vector<SurfaceOwner>& owners,
                                                  const Scene& scene)
{
    std::vector<std::vector<Vec3>> out(owners.size());
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const SurfaceOwner& owner = owners[i];
        if (!isLine(scene, owner)) continue;
        const std::vector<Vec3>&v = scene.soft[owner.body].state.v, &dv = scene.soft[owner.body].system.dv;
        bool faster = false;
        for (std::size_t n = 0; n < v.size() && !faster; ++n)
            faster = dt * length(v[n] + dv[n]) > owner.collision->proximity + kStepsAhead * dt * length(v[n]);
        if (!faster) continue;
        for (std::size_t n = 0; n < v.size(); ++n) out[i].push_back(v[n] + dv[n]);
    }
    return out;
}

} // namespace

Vec3 betweenEdges(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b)
{
    Vec3 best = a[0] - b[0];
    const auto consider = [&](Vec3 between) {
        if (lengthSquared(between) < lengthSquared(best)) best = between;
    };
    for (const Vec3 p : a) consider(p - geometry::nearestOnSegment(p, b[0], b[1]).point);
    for (const Vec3 p : b) consider(geometry::nearestOnSegment(p, a[0], a[1]).point - p);
    const Vec3 u = a[1] - a[0], v = b[1] - b[0], r = b[0] - a[0], across = cross(u, v);
    const double area = lengthSquared(across);
    if (!(area > 1e-10 * lengthSquared(u) * lengthSquared(v))) return best;
    const double s = dot(cross(r, v), across) / area, t = dot(cross(r, u), across) / area;
    if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) consider(s * u - t * v - r);
    return best;
}

void addPlane(const FeatureCorners& one, const FeatureCorners& two, Vec3 between, Vec3 across, double radii,
              std::array<std::size_t, 2> bodies, std::vector<MissedContact>& out)
{
    const double now = length(between);
    const Vec3 normal = normalized(between, across);
    for (std::size_t m = 0; m < 3 && one.vertices[m] >= 0; ++m)
        for (std::size_t n = 0; n < 3 && two.vertices[n] >= 0; ++n) {
            MissedContact& each = out.emplace_back();
            each.bodies = bodies;
            each.line = true;
            each.at = {.surfaces = {one.surface, two.surface},
                       .vertices = {{{one.vertices[m], -1, -1}, {two.vertices[n], -1, -1}}},
                       .weights = {{{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}},
                       .normal = normal};
            // They may come a tenth nearer than they are, or than they should be.
            each.at.gap = dot(one.x[m] - two.x[n], normal) + radii - kNearer * std::min(now, radii);
        }
}

std::vector<MissedContact> findLinePasses(double dt, const Scene& scene, const Coupling& coupling)
{
    std::vector<SweptLine> lines;
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    for (std::size_t i = 0; i < owners.size(); ++i)
        if (const SurfaceOwner& owner = owners[i]; isLine(scene, owner))
            lines.push_back(sweptLine(dt, scene.soft[owner.body], owner.body, static_cast<int>(i),
                                      *coupling.detection.surfaces[i].shape));
    std::vector<MissedContact> out;
    for (const SweptLine& one : lines)
        for (const SweptLine& two : lines) {
            if (two.place < one.place || one.shape->group != two.shape->group) continue;
            if (one.place == two.place && !one.shape->self) continue;
            findBetween(one, two, scene.soft[one.body].model.rod.radius + scene.soft[two.body].model.rod.radius, out);
        }
    return out;
}

std::vector<MissedContact> findUnforeseen(const StepContext& context, const Scene& scene, Coupling& coupling)
{
    ContactDetection& detection = coupling.detection;
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    std::vector<std::vector<Vec3>> fast = fasterThanForeseen(context.dt, owners, scene);
    std::vector<MissedContact> out;
    if (std::ranges::all_of(fast, [](const auto& each) { return each.empty(); })) return out;
    // Exchanged, too, those of the fast surfaces are not empty.
    const auto isFast = [&](std::size_t i) { return !fast[i].empty(); };
    const auto exchange = [&] {
        for (std::size_t i = 0; i < fast.size(); ++i)
            if (isFast(i)) std::swap(fast[i], detection.surfaces[i].v);
    };
    exchange();
    std::vector<SheetSide> sides = scene.sides;
    std::vector<Proximity> found;
    findProximities(detection.surfaces, context.dt, context.pool, detection.pushed, sides, detection.scratch, found);
    std::vector<std::uint64_t> known;
    for (const Constraint& each : coupling.contacts()) known.push_back(each.contact.cached.feature);
    std::ranges::sort(known);
    for (const Proximity& each : found) {
        const auto one = static_cast<std::size_t>(each.surfaces[0]), two = static_cast<std::size_t>(each.surfaces[1]);
        if (!(isFast(one) || isFast(two)) || (isLine(scene, owners[one]) && isLine(scene, owners[two]))) continue;
        const double radius = scene.soft[owners[isFast(one) ? one : two].body].model.rod.radius;
        if (!(context.dt * closingSpeed(detection.surfaces, each) > each.gap - radius)) continue;
        if (!std::ranges::binary_search(known, each.feature)) out.push_back({.at = each});
    }
    exchange();
    return out;
}

} // namespace filasofia::engine
