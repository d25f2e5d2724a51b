#include "apps/filasofia/bench/contact_moves.h"

#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::app {
namespace {

constexpr double kFar = 0.17;         ///< [m] from the middle: far enough not to touch the body
constexpr double kDeepest = 0.015;    ///< [m] depth of the axis below the surface at rest
constexpr double kFromPinned = 0.025; ///< [m] from the axis to the pinned part of the body
constexpr double kOff = 0.02;         ///< [m] distance between a tool and the surface before and after it touches
constexpr double kPeak = 1.5;         ///< [-] peak speed / mean speed of a smooth step

double smooth(double t) { return t * t * (3.0 - 2.0 * t); }

Quat blend(Quat a, Quat b, double t)
{
    if (dot(a, b) < 0.0) b = {-b.w, -b.x, -b.y, -b.z};
    const Vec3 turn = rotationVector(normalized(b * conjugate(a)));
    return normalized(axisAngle(turn, t * length(turn)) * a);
}

Pose blend(const Pose& a, const Pose& b, double t)
{
    return {(1.0 - t) * a.position + t * b.position, blend(a.orientation, b.orientation, t)};
}

/// The rotation that takes y, a capsule's axis, to a direction.
Quat turnTo(Vec3 direction)
{
    const Vec3 axis = cross(Vec3{0, 1, 0}, direction);
    if (length(axis) < 1e-9) return direction.y > 0.0 ? Quat{} : Quat{0, 1, 0, 0};
    return axisAngle(axis, std::acos(std::clamp(direction.y, -1.0, 1.0)));
}

std::vector<geometry::Box> boxesOf(const std::vector<Vec3>& points, const auto& simplices)
{
    std::vector<geometry::Box> boxes;
    for (const auto& simplex : simplices) {
        geometry::Box box;
        for (int i : simplex) box = merged(box, points[static_cast<std::size_t>(i)]);
        boxes.push_back(box);
    }
    return boxes;
}

} // namespace

RandomMoves::RandomMoves(const geometry::TetMesh& mesh, double pinnedBelow, Capsule capsule, int seed)
    : mesh_(mesh), surface_(geometry::extractSurface(mesh).mesh),
      triangles_(boxesOf(surface_.vertices, surface_.triangles)), tetrahedra_(boxesOf(mesh_.nodes, mesh_.tetrahedra)),
      pinnedBelow_(pinnedBelow), capsule_(capsule), source_(static_cast<std::uint32_t>(seed))
{
    middle_ = 0.5 * (triangles_.bounds().low + triangles_.bounds().high);
    from_ = {parked(0), parked(1)};
}

Pose RandomMoves::parked(int tool) const { return {middle_ + Vec3{tool == 0 ? kFar : -kFar, 0.0, 0.0}, {}}; }

std::array<Pose, 2> RandomMoves::at(double time)
{
    for (;;) {
        if (moves_.empty()) plan();
        const Move& move = moves_.front();
        const double takes = std::max(1e-3, kPeak * lengthOf(move) / move.speed);
        if (const double gone = time - begun_; gone < takes + move.rest) {
            const double t = smooth(std::min(1.0, gone / takes));
            return {blend(from_[0], move.to[0], t), blend(from_[1], move.to[1], t)};
        }
        begun_ += takes + move.rest;
        from_ = move.to;
        moves_.erase(moves_.begin());
    }
}

void RandomMoves::leave(double time)
{
    from_ = at(time);
    begun_ = time;
    moves_ = {{{outside(from_[0]), outside(from_[1])}, 1.0, 1e9}};
    doing_ = "leaving";
}

/// [m] an upper bound of the longest path of any point of a tool.
double RandomMoves::lengthOf(const Move& move) const
{
    double longest = 0.0;
    for (std::size_t k = 0; k < 2; ++k) {
        const Quat turn = move.to[k].orientation * conjugate(from_[k].orientation);
        const double angle = 2.0 * std::acos(std::min(1.0, std::abs(turn.w)));
        longest = std::max(longest, distance(from_[k].position, move.to[k].position) +
                                        angle * (capsule_.half + capsule_.radius));
    }
    return longest;
}

void RandomMoves::plan()
{
    const bool grasps = random(0.0, 1.0) < 0.3;
    for (int tries = 0; tries < 1000; ++tries)
        if (grasps ? planGrasp() : planTouch()) return;
    while (!planTouch()) {
    }
}

/// Presses the first tool in at a random angle, and in some cases scrapes along the surface.
bool RandomMoves::planTouch()
{
    const Place place = randomPlace();
    const Vec3 across = normalized(cross(place.normal, randomDirection()));
    const double tilt = random(0.0, 0.5 * std::numbers::pi);
    const Vec3 axis = std::cos(tilt) * place.normal + std::sin(tilt) * across;
    const double reach = capsule_.half * std::cos(tilt) + capsule_.radius; // from its middle down to its lowest point
    const auto above = [&](double height) { return Pose{place.point + (reach + height) * place.normal, turnTo(axis)}; };
    const Pose start = above(kOff), deep = above(-random(0.002, 0.02));
    Pose scraped = deep;
    const bool scrapes = random(0.0, 1.0) < 0.6;
    if (scrapes) scraped.position += random(0.01, 0.06) * normalized(cross(place.normal, randomDirection()));
    Pose end = scraped;
    end.position += 2.0 * kOff * place.normal;
    if (!fitsAlong(start, deep) || !fitsAlong(deep, scraped) || !fitsAlong(scraped, end)) return false;
    doing_ = scrapes ? "scrape" : "press";
    if (fitsAlong(from_[0], start) && distance(from_[1].position, parked(1).position) < 1e-9)
        moves_.push_back({{start, parked(1)}, random(0.3, 1.0), 0.0}); // straight there, through whatever is in its way
    else
        travel({start, parked(1)});
    moves_.push_back({{deep, parked(1)}, random(0.05, 1.0), random(0.0, 0.2)});
    if (scrapes) moves_.push_back({{scraped, parked(1)}, random(0.05, 1.0), random(0.0, 0.1)});
    moves_.push_back({{end, parked(1)}, random(0.1, 1.0), 0.0});
    return true;
}

/// Takes a thin part between both tools, closes them to about half of its thickness, pulls and lets go.
bool RandomMoves::planGrasp()
{
    const Place near = randomPlace();
    Place far;
    const double thick = thickness(near, far);
    if (!(thick > 0.01 && thick < 0.045) || far.point.y < pinnedBelow_ + kFromPinned) return false;
    const Vec3 way = normalized(far.point - near.point), axis = normalized(cross(way, randomDirection()));
    const auto jaws = [&](double apart) { // both at the same distance from the surface
        const double out = capsule_.radius + apart;
        return std::array{Pose{near.point - out * way, turnTo(axis)}, Pose{far.point + out * way, turnTo(axis)}};
    };
    const auto open = jaws(0.01), closed = jaws(-0.25 * thick);
    for (std::size_t k = 0; k < 2; ++k)
        if (!fitsAlong(open[k], closed[k])) return false;
    const Vec3 pull = random(0.0, 0.02) * randomDirection();
    auto pulled = closed, opened = open;
    for (std::size_t k = 0; k < 2; ++k) {
        pulled[k].position += pull;
        opened[k].position += pull;
    }
    doing_ = "grasp";
    travel(open);
    moves_.push_back({closed, random(0.05, 0.5), random(0.0, 0.2)});
    moves_.push_back({pulled, random(0.05, 1.0), random(0.0, 0.2)});
    moves_.push_back({opened, random(0.05, 0.5), 0.0});
    moves_.push_back({{outside(opened[0]), outside(opened[1])}, 1.0, 0.0});
    return true;
}

/// Out, around, and in again.
void RandomMoves::travel(std::array<Pose, 2> to)
{
    const std::array<Pose, 2> from = moves_.empty() ? from_ : moves_.back().to;
    constexpr int kLegs = 4;
    const double speed = random(0.5, 1.0);
    for (int leg = 0; leg <= kLegs; ++leg) {
        std::array<Pose, 2> next;
        for (std::size_t k = 0; k < 2; ++k) {
            const Vec3 a = normalized(from[k].position - middle_, {0, 1, 0}),
                       b = normalized(to[k].position - middle_, {0, 1, 0});
            const double t = static_cast<double>(leg) / kLegs;
            // Around in equal angles. Between opposite places there is no unique shortest path: it goes over the top.
            const Vec3 turn = dot(a, b) < -0.999
                                  ? std::numbers::pi * normalized(cross(a, Vec3{0, 1, 0}), {1, 0, 0})
                                  : std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * normalized(cross(a, b));
            next[k] = {middle_ + kFar * rotate(axisAngle(turn, t * length(turn)), a),
                       blend(from[k].orientation, to[k].orientation, t)};
        }
        moves_.push_back({next, speed, 0.0});
    }
    moves_.push_back({to, speed, 0.0});
}

Pose RandomMoves::outside(const Pose& pose) const
{
    return {middle_ + kFar * normalized(pose.position - middle_, {0, 1, 0}), pose.orientation};
}

bool RandomMoves::fits(const Pose& pose) const
{
    constexpr int kPoints = 9;
    for (int i = 0; i < kPoints; ++i) {
        const Vec3 p = transform(pose, {0, capsule_.half * (2.0 * i / (kPoints - 1) - 1.0), 0});
        if (p.y < pinnedBelow_ + kFromPinned || depthOf(p) > kDeepest) return false;
    }
    return true;
}

bool RandomMoves::fitsAlong(const Pose& from, const Pose& to) const
{
    constexpr double kLeg = 0.005; // [m]
    const int legs = 5 + static_cast<int>(distance(from.position, to.position) / kLeg);
    for (int i = 0; i <= legs; ++i)
        if (!fits(blend(from, to, static_cast<double>(i) / legs))) return false;
    return true;
}

/// [m] depth below the surface at rest; 0 if the point is outside.
double RandomMoves::depthOf(Vec3 point) const
{
    std::vector<int> around;
    tetrahedra_.overlapping({point, point}, around);
    const bool inside = std::ranges::any_of(around, [&](int t) {
        std::array<Vec3, 4> c;
        for (std::size_t k = 0; k < 4; ++k)
            c[k] = mesh_.nodes[static_cast<std::size_t>(mesh_.tetrahedra[static_cast<std::size_t>(t)][k])];
        return std::ranges::min(geometry::barycentric(point, c[0], c[1], c[2], c[3])) >= 0.0;
    });
    if (!inside) return 0.0;
    const auto found = triangles_.nearest(point, [&](int t) {
        const auto& [a, b, c] = surface_.triangles[static_cast<std::size_t>(t)];
        const auto at = [&](int i) { return surface_.vertices[static_cast<std::size_t>(i)]; };
        return geometry::nearestOnTriangle(point, at(a), at(b), at(c)).squaredDistance;
    });
    return std::sqrt(found.value);
}

/// [m] distance from a place straight through to the other side.
double RandomMoves::thickness(const Place& place, Place& exit) const
{
    const Vec3 start = place.point - 1e-5 * place.normal;
    const auto found = triangles_.firstHit(start, -place.normal, [&](int t) {
        const auto& [a, b, c] = surface_.triangles[static_cast<std::size_t>(t)];
        const auto at = [&](int i) { return surface_.vertices[static_cast<std::size_t>(i)]; };
        return geometry::rayTriangle(start, -place.normal, at(a), at(b), at(c));
    });
    if (found.primitive < 0) return 0.0;
    exit = {start - found.value * place.normal, -place.normal};
    return found.value;
}

RandomMoves::Place RandomMoves::randomPlace()
{
    for (;;) {
        const auto t = static_cast<std::size_t>(random(0.0, static_cast<double>(surface_.triangles.size()) - 0.5));
        std::array<Vec3, 3> c;
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = surface_.vertices[static_cast<std::size_t>(surface_.triangles[t][k])];
        const Vec3 point = (c[0] + c[1] + c[2]) / 3.0;
        if (point.y > pinnedBelow_ + kFromPinned)
            return {point, normalized(cross(c[1] - c[0], c[2] - c[0]), {0, 1, 0})};
    }
}

Vec3 RandomMoves::randomDirection()
{
    for (;;) {
        const double x = random(-1, 1), y = random(-1, 1), z = random(-1, 1);
        const Vec3 v{x, y, z};
        if (const double l = length(v); l > 0.1 && l < 1.0) return v / l;
    }
}

/// Written out so that every standard library yields the same numbers.
double RandomMoves::random(double low, double high)
{
    return low + (high - low) * (static_cast<double>(source_()) / 4294967296.0);
}

} // namespace filasofia::app
