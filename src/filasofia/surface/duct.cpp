#include "filasofia/surface/duct.h"

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/core/error.h"
#include "filasofia/surface/lumen.h"
#include "filasofia/surface/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace filasofia::surface {
namespace {

constexpr std::size_t kAround = 16;    // points of a ring
constexpr std::size_t kStations = 400; // at most
constexpr double kLongest = 100.0;     // [m]
constexpr double kFarFromBody = 3.0;   // [-] times its radius: a ring farther away is in no tissue
constexpr int kBesideClip = 2;         // stations: what is shut so near to a clip is shut by it
// Stations face along a path that is sampled; at a bend by more than 139 degrees they would face nowhere.
constexpr double kSharpest = -0.75;    // [-] cosine of the sharpest bend
constexpr double kLeastStride = 0.45;  // [-] times the spacing: from one station to that behind the next
constexpr double kOutOfBody = 0.5;     // [-] times its radius: how far the tube may lie off the tissue around it
constexpr double kBetweenNodes = 0.75; // [-] times an edge of the mesh: as far is a point between nodes from them
constexpr double kMayCross = 0.25;     // [-] a ring that is more open than that has not been pressed through itself
constexpr double kPi = std::numbers::pi;

/// [Pa s/m^3] The resistance between two open stations.
double openSpacing(const DuctDef& def, double spacing)
{
    return 8.0 * def.viscosity * spacing / (kPi * std::pow(def.radius, 4));
}

Vec3 acrossOf(Vec3 along)
{
    const Vec3 a = std::abs(along.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(cross(along, a));
}

/// Places at equal distances along a line, its ends among them, and the directions there.
struct Line {
    std::vector<Vec3> places = {}, directions = {};
    double spacing = 0.0; ///< [m]
};

/// Stations face along the line from the one before to the one behind, as they do in every step.
void face(Line& line, const std::string& object)
{
    const std::size_t n = line.places.size();
    for (std::size_t s = 0; s < n; ++s) {
        const Vec3 along = line.places[std::min(s + 1, n - 1)] - line.places[s > 0 ? s - 1 : 0];
        if (!(length(along) > kLeastStride * line.spacing))
            fail(object, ": path must not turn back, but does ", line.spacing * static_cast<double>(s),
                 " m behind its start");
        line.directions.push_back(normalized(along));
    }
}

Line stationsOf(const std::vector<Vec3>& path, double radius, const std::string& object)
{
    double whole = 0.0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) whole += distance(path[i], path[i + 1]);
    if (!(whole <= kLongest)) fail(object, ": path must be at most ", kLongest, " m long, got ", whole);
    if (!(whole >= radius)) fail(object, ": path must be at least as long as its radius, ", radius, " m, got ", whole);
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
        if (dot(normalized(path[i] - path[i - 1]), normalized(path[i + 1] - path[i])) < kSharpest)
            fail(object, ": path must not turn back, but does at path[", i, "]");
    const auto parts = static_cast<std::size_t>(std::clamp(std::ceil(whole / radius), 2.0, kStations - 1.0));
    Line line{.spacing = whole / static_cast<double>(parts)};
    std::size_t edge = 0;
    double before = 0.0;
    for (std::size_t s = 0; s <= parts; ++s) {
        const double along = line.spacing * static_cast<double>(s);
        while (edge + 2 < path.size() && before + distance(path[edge], path[edge + 1]) < along)
            before += distance(path[edge], path[edge + 1]), ++edge;
        line.places.push_back(path[edge] + (along - before) * normalized(path[edge + 1] - path[edge]));
    }
    face(line, object);
    return line;
}

/// [-] The flow per pressure of an ellipse with these half axes over that of a circle.
double conductanceOf(double a, double b, double radius)
{
    return 2.0 * a * a * a * b * b * b / ((a * a + b * b) * radius * radius * radius * radius);
}

/// [-] The openness of a ring that may cross itself: where a clip is too short or does not open far enough, walls pass
/// through each other beside a lumen that stays. Lobes that are turned inside out are shut, through the others flows
/// what flows through ellipses of their areas and second moments.
double opennessOfLobes(const Outline& ring, double radius)
{
    double open = 0.0;
    for (const Outline& lobe : lobesOf(ring)) {
        const auto [area, xx, yy, xy] = momentsOf(lobe);
        if (!(area > 0.0)) continue;
        const double mean = 2.0 * (xx + yy) / area, spread = 2.0 * std::hypot(xx - yy, 2.0 * xy) / area;
        const double a = std::sqrt(mean + spread); // an ellipse has the moments a^2 / 4 and b^2 / 4 times its area
        if (a > 0.0) open += conductanceOf(a, std::min(a, area / (kPi * a)), radius);
    }
    return open;
}

/// [-] The flow per pressure of an ellipse over that of a circle of this radius. The ring of points goes around
/// `along`.
double opennessOf(std::span<const Vec3> ring, Vec3 middle, Vec3 along, double radius)
{
    const Vec3 u = acrossOf(along), v = cross(along, u);
    double xx = 0.0, yy = 0.0, xy = 0.0, twice = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec3 p = ring[i] - middle, q = ring[(i + 1) % ring.size()] - middle;
        const double x = dot(p, u), y = dot(p, v);
        xx += x * x, yy += y * y, xy += x * y;
        twice += x * dot(q, v) - y * dot(q, u);
    }
    const auto n = static_cast<double>(ring.size());
    const double mean = (xx + yy) / n, spread = std::hypot((xx - yy) / n, 2.0 * xy / n);
    const double a = std::sqrt(mean + spread); // a ring of an ellipse has the moments a^2 / 2 and b^2 / 2
    const double area = 0.5 * twice * 2.0 * kPi / (n * std::sin(2.0 * kPi / n)); // the ellipse around the corners
    const double open = area > 0.0 && a > 0.0 ? conductanceOf(a, std::min(a, area / (kPi * a)), radius) : 0.0;
    if (open > kMayCross) return open;
    Outline outline;
    for (const Vec3 each : ring) outline.push_back({dot(each - middle, u), dot(each - middle, v)});
    return crossesItself(outline) ? opennessOfLobes(outline, radius) : open;
}

} // namespace

Duct::Duct(const DuctDef& def, const geometry::TetMesh& mesh, std::span<const geometry::Triangle> skin,
           const std::string& object)
    : def_(def)
{
    if (def.path.size() < 2) fail(object, ": path must have at least two points, got ", def.path.size());
    for (std::size_t i = 0; i + 1 < def.path.size(); ++i)
        if (distance(def.path[i], def.path[i + 1]) == 0.0)
            fail(object, ": path[", i, "] and path[", i + 1, "] must be two places, got one");
    const Line line = stationsOf(def.path, def.radius, object);
    spacing_ = line.spacing;
    std::vector<Vec3> points;
    for (std::size_t s = 0; s < line.places.size(); ++s) {
        const Vec3 u = acrossOf(line.directions[s]), v = cross(line.directions[s], u);
        for (std::size_t i = 0; i < kAround; ++i) {
            const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(kAround);
            points.push_back(line.places[s] + def.radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
    }
    points_ = geometry::embed(mesh, points);
    findNear(mesh, skin, points, object);
    checkRadius(def.radius, {.middles = line.places, .points = points}, mesh, skin, object);
    middles_ = line.places;
}

void Duct::findNear(const geometry::TetMesh& mesh, std::span<const geometry::Triangle> skin,
                    std::span<const Vec3> points, const std::string& object)
{
    std::vector<int> nodes;
    std::vector<double> edges(mesh.nodes.size()); // [m] the longest at each node of the skin
    DisjointSets walls(mesh.nodes.size());        // a hollow body has a wall of its own inside
    for (const geometry::Triangle& t : skin) {
        nodes.insert(nodes.end(), t.begin(), t.end());
        walls.join(t[0], t[1]);
        walls.join(t[1], t[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            const double edge =
                distance(mesh.nodes[static_cast<std::size_t>(a)], mesh.nodes[static_cast<std::size_t>(b)]);
            for (const int node : {a, b})
                edges[static_cast<std::size_t>(node)] = std::max(edges[static_cast<std::size_t>(node)], edge);
        }
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    const auto nearestTo = [&](Vec3 point) {
        const auto far = [&](int node) { return lengthSquared(mesh.nodes[static_cast<std::size_t>(node)] - point); };
        return *std::ranges::min_element(nodes, {}, far);
    };
    std::map<int, int> votes;
    double off = 0.0, least = std::numeric_limits<double>::infinity(); // [m] a ring's mean; the best ring
    for (Vec3 point : points) {
        near_.push_back(nearestTo(point));
        const double far = distance(mesh.nodes[static_cast<std::size_t>(near_.back())], point);
        if (!(far < kFarFromBody * def_.radius + 2.0 * spacing_))
            fail(object, ": path must run through the body, but is ", far, " m away from it");
        // Where the mesh is coarse, its nodes are far from what is between them.
        off += (far - kBetweenNodes * edges[static_cast<std::size_t>(near_.back())]) / kAround;
        if (near_.size() % kAround == 0) least = std::min(least, std::exchange(off, 0.0));
        ++votes[walls.find(near_.back())];
    }
    if (least > kOutOfBody * def_.radius)
        fail(object, ": radius must be that of a tube through the body, but one of ", def_.radius, " m is ", least,
             " m away from it everywhere");
    // All follow one wall: two walls that were never one would look like a cut.
    const int wall = std::ranges::max_element(votes, {}, [](const auto& each) { return each.second; })->first;
    std::erase_if(nodes, [&](int node) { return walls.find(node) != wall; });
    for (std::size_t i = 0; i < near_.size(); ++i)
        if (walls.find(near_[i]) != wall) near_[i] = nearestTo(points[i]);
}

void Duct::follow(std::span<const Vec3> positions)
{
    ring_.assign(points_.nodes.size(), Vec3{});
    for (std::size_t i = 0; i < ring_.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            ring_[i] += points_.weights[i][k] * positions[static_cast<std::size_t>(points_.nodes[i][k])];
    for (std::size_t s = 0; s < middles_.size(); ++s) {
        middles_[s] = {};
        for (std::size_t i = 0; i < kAround; ++i)
            middles_[s] += 1.0 / static_cast<double>(kAround) * ring_[kAround * s + i];
    }
}

void Duct::measureConductances()
{
    const std::size_t n = middles_.size();
    open_.assign(n, 0.0);
    for (std::size_t s = 0; s < n; ++s) {
        const Vec3 along = middles_[std::min(s + 1, n - 1)] - middles_[s > 0 ? s - 1 : 0];
        if (length(along) == 0.0) continue;
        open_[s] =
            opennessOf(std::span(ring_).subspan(kAround * s, kAround), middles_[s], normalized(along), def_.radius);
    }
}

void Duct::findCut(const DuctBody& body)
{
    const std::uint64_t now = body.boundary ? body.boundary->revision : 0;
    if (now == revision_) return;
    revision_ = now;
    cuts_.clear();
    if (now == 0) return;
    DisjointSets parts(body.positions.size());
    std::vector<char> there(body.positions.size());
    for (const auto& [a, b, c] : body.boundary->triangles) {
        parts.join(a, b);
        parts.join(b, c);
        for (int node : {a, b, c}) there[static_cast<std::size_t>(node)] = 1;
    }
    // The part that most of a ring's nodes are in; -1: that of a piece that was removed.
    const auto partOf = [&](std::size_t station) {
        std::array<int, kAround> found{};
        for (std::size_t i = 0; i < kAround; ++i) {
            const int node = near_[kAround * station + i];
            found[i] = there[static_cast<std::size_t>(node)] ? parts.find(node) : -1;
        }
        return *std::ranges::max_element(found, {}, [&](int part) { return std::ranges::count(found, part); });
    };
    for (std::size_t s = 0; s + 1 < middles_.size(); ++s)
        if (const int here = partOf(s); here == -1 || here != partOf(s + 1)) cuts_.push_back(static_cast<int>(s));
    if (cuts_.empty()) return;
    const std::array stations = {static_cast<std::size_t>(cuts_.front()), static_cast<std::size_t>(cuts_.back()) + 1};
    for (std::size_t end = 0; end < 2; ++end) { // a ring may be torn: those of its nodes that are on this side
        endNodes_[end].clear();
        const int part = partOf(stations[end]);
        for (std::size_t i = 0; i < kAround; ++i) {
            const int node = near_[kAround * stations[end] + i];
            if (there[static_cast<std::size_t>(node)] && parts.find(node) == part) endNodes_[end].push_back(node);
        }
    }
}

int Duct::stationOf(const frame::Clip& clip) const
{
    const auto far = [&](Vec3 middle) { return distance(middle, clip.place); };
    const auto at = std::ranges::min_element(middles_, {}, far) - middles_.begin();
    const Vec3 middle = middles_[static_cast<std::size_t>(at)];
    if (far(middle) > kFarFromBody * def_.radius + spacing_) return -1;
    // Before the inlet or behind the outlet it is on another tube.
    if (at != 0 && at != lastStation()) return static_cast<int>(at);
    const Vec3 outwards = middle - middles_[static_cast<std::size_t>(at == 0 ? 1 : lastStation() - 1)];
    const bool beyond = dot(clip.place - middle, outwards) > 0.5 * lengthSquared(outwards);
    return beyond ? -1 : static_cast<int>(at);
}

/// [Pa s/m^3] From one station to another; infinite if one of them is shut.
double Duct::resistance(int from, int to) const
{
    double sum = 0.0;
    for (int s = from; s < to; ++s) {
        const double here = open_[static_cast<std::size_t>(s)], next = open_[static_cast<std::size_t>(s) + 1];
        if (std::min(here, next) < def_.shutBelow) return std::numeric_limits<double>::infinity();
        sum += 0.5 * openSpacing(def_, spacing_) * (1.0 / here + 1.0 / next); // one behind the other
    }
    return sum;
}

void Duct::flowThrough(DuctBalance& now) const
{
    const double all = def_.inletResistance + def_.outletResistance + resistance(0, lastStation());
    const bool shut = std::isinf(all);
    now.flow = shut ? 0.0 : (def_.inletPressure - def_.outletPressure) / all;
    const bool byClip = std::ranges::any_of(clipped_, [&](int at) {
        const int from = std::max(0, at - kBesideClip), to = std::min(lastStation(), at + kBesideClip);
        return std::any_of(open_.begin() + from, open_.begin() + to + 1,
                           [&](double each) { return each < def_.shutBelow; });
    });
    now.state = !shut ? DuctState::Open : byClip ? DuctState::Clipped : DuctState::Squeezed;
}

void Duct::leakOut(const DuctBody& body, double dt, DuctBalance& now)
{
    // The stations beside a cut are not asked: their rings are torn. Even at its very end a tube resists.
    const double least = openSpacing(def_, spacing_);
    const auto leak = [&](double pressure, double supply, int from, int to) {
        return std::max(0.0, pressure / (supply + std::max(least, resistance(from, to))));
    };
    const int before = cuts_.front(), after = cuts_.back() + 1, last = lastStation();
    const double in = leak(def_.inletPressure, def_.inletResistance, 0, std::max(0, before - 1));
    const double out = leak(def_.outletPressure, def_.outletResistance, std::min(last, after + 1), last);
    now.leak = in + out;
    now.lost += dt * now.leak;
    now.state = now.leak > 0.0 ? DuctState::Leaking : DuctState::Cut;
    const auto placeOf = [&](std::size_t end, int station) {
        if (endNodes_[end].empty()) return middles_[static_cast<std::size_t>(station)];
        Vec3 sum;
        for (const int node : endNodes_[end]) sum += body.positions[static_cast<std::size_t>(node)];
        return 1.0 / static_cast<double>(endNodes_[end].size()) * sum;
    };
    ends_.push_back({placeOf(0, before), in});
    ends_.push_back({placeOf(1, after), out});
}

void Duct::step(const DuctBody& body, double dt)
{
    follow(body.positions);
    measureConductances();
    findCut(body);
    DuctBalance now{.lost = balance_.lost};
    now.narrowest = *std::ranges::min_element(open_);
    const int before = cuts_.empty() ? lastStation() : cuts_.front(), after = cuts_.empty() ? 0 : cuts_.back() + 1;
    clipped_.clear();
    for (const frame::Clip& clip : body.clips) {
        const int at = stationOf(clip);
        if (at < 0) continue;
        clipped_.push_back(at);
        if (at <= before)
            ++now.clipsBefore;
        else if (at >= after)
            ++now.clipsAfter; // those between two cuts keep nothing back
    }
    ends_.clear();
    if (cuts_.empty())
        flowThrough(now);
    else
        leakOut(body, dt, now);
    balance_ = now;
}

void Duct::restart()
{
    balance_ = {};
    ends_.clear();
    revision_ = 0;
    cuts_.clear();
    endNodes_ = {};
}

} // namespace filasofia::surface
