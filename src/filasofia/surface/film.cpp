#include "filasofia/surface/film.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::surface {
namespace {

/// Blood of this many time constants is solid; the limit keeps the exponential finite.
constexpr double kSolid = 20.0;

/// What one step of the film reads.
struct Pass {
    const FilmTopology& topology;
    const FilmGeometry& geometry;
    const FilmLiquid& liquid;
    double dt;
    std::vector<double> levels; ///< [m] per vertex at the step's start
};

/// The film's free surface above a reference [m]: what drives it downhill, and levels it where it can lie.
double level(const FilmGeometry& geometry, const FilmContent& content, int v)
{
    const double thickness = geometry.area[v] > 0.0 ? content.volume[v] / geometry.area[v] : 0.0;
    return geometry.elevation[v] + std::max(geometry.upward[v], 0.0) * thickness;
}

double viscosityOf(const FilmLiquid& liquid, const FilmContent& content, int v)
{
    const double age = content.volume[v] > 0.0 ? content.aged[v] / content.volume[v] : 0.0;
    return liquid.viscosity * std::exp(std::min(age / liquid.hardening, kSolid));
}

/// Moves volume with its age.
void move(FilmContent& content, int from, int to, double volume)
{
    const double age = content.volume[from] > 0.0 ? content.aged[from] / content.volume[from] : 0.0;
    content.volume[from] -= volume;
    content.aged[from] -= volume * age;
    content.volume[to] += volume;
    content.aged[to] += volume * age;
}

/// Takes volume away with its age.
double take(FilmContent& content, int from, double volume)
{
    volume = std::min(volume, content.volume[from]);
    const double left = content.volume[from] - volume;
    content.aged[from] *= content.volume[from] > 0.0 ? left / content.volume[from] : 0.0;
    content.volume[from] = left;
    return volume;
}

/// Drops fall from a vertex. Returns what lands nowhere.
double fall(const FilmGeometry& geometry, int from, double volume, FilmContent& content)
{
    const int to = geometry.landing.empty() ? FilmGeometry::kPast : geometry.landing[from];
    if (to == FilmGeometry::kUnknown) return 0.0;
    if (to < 0 || !(geometry.area[to] > 0.0)) return take(content, from, volume);
    move(content, from, to, std::min(volume, content.volume[from]));
    return 0.0;
}

/// How much one vertex may give another until both are level.
double untilLevel(const FilmGeometry& geometry, int from, int to, double drop)
{
    const double rise = std::max(geometry.upward[from], 0.0) / geometry.area[from] +
                        std::max(geometry.upward[to], 0.0) / geometry.area[to];
    return rise > 0.0 ? drop / rise : std::numeric_limits<double>::infinity();
}

/// One vertex gives to those below it: Reynolds' lubrication law (Oron, Davis and Bankoff 1997) for a film whose
/// viscosity and slope are those of the step's start, and whose thickness is that of its end. Returns what left at a
/// rim.
double giveDown(const Pass& pass, int v, FilmContent& content)
{
    const auto& [topology, geometry, liquid, dt, levels] = pass;
    const double area = geometry.area[v], held = liquid.clinging * area, mobile = content.volume[v] - held;
    if (mobile <= 0.0) return 0.0;
    const auto push = [&](int e) { // conductance times drop [m]; 0 where there is no area
        return pass.geometry.conductance[e] * std::max(pass.levels[v] - pass.levels[pass.topology.next[e]], 0.0);
    };
    double all = geometry.rim[v];
    for (int e = topology.first[v]; e < topology.first[v + 1]; ++e) all += push(e);
    if (all <= 0.0) return 0.0;
    const double speed = dt * liquid.density * geometry.gravity / (3.0 * viscosityOf(liquid, content, v)) / area;
    const double gone = std::clamp(mobile - area * implicitThickness(mobile / area, speed * all), 0.0, mobile);
    const double dripped = fall(geometry, v, gone * geometry.rim[v] / all, content);
    for (int e = topology.first[v]; e < topology.first[v + 1]; ++e) {
        const int to = topology.next[e];
        const double wanted = gone * push(e) / all;
        if (wanted <= 0.0 || !(geometry.area[to] > 0.0)) continue;
        // Not past the point where both are level as they are by now: heights are never exchanged.
        const double drop = level(geometry, content, v) - level(geometry, content, to);
        if (drop > 0.0)
            move(content, v, to, std::min({wanted, untilLevel(geometry, v, to, drop), content.volume[v] - held}));
    }
    return dripped;
}

/// A film under an overhang gathers to drops: growth of the fastest wave of the Rayleigh-Taylor instability (Fermigier
/// et al. 1992: (rho g)^2 h^3 / (12 mu gamma)), integrated over the step.
double drip(const Pass& pass, int v, FilmContent& content)
{
    const auto& [topology, geometry, liquid, dt, levels] = pass;
    if (geometry.upward[v] >= 0.0) return 0.0;
    const double mobile = content.volume[v] / geometry.area[v] - liquid.clinging;
    if (mobile <= 0.0) return 0.0;
    const double weight = liquid.density * geometry.gravity * -geometry.upward[v];
    const double growth = weight * weight / (12.0 * viscosityOf(liquid, content, v) * liquid.surfaceTension);
    const double left = mobile / std::cbrt(1.0 + 3.0 * growth * dt * mobile * mobile * mobile);
    return fall(geometry, v, (mobile - left) * geometry.area[v], content);
}

} // namespace

double implicitThickness(double b, double c)
{
    if (b <= 0.0) return 0.0;
    // From above, where the curve is convex, Newton's method falls towards the root and never past it.
    double x = c * b * b > 1.0 ? std::min(b, std::cbrt(b / c)) : b;
    for (int i = 0; i < 8; ++i) x -= (x + c * x * x * x - b) / (1.0 + 3.0 * c * x * x);
    return std::clamp(x, 0.0, b);
}

FilmTopology filmTopology(int vertices, std::vector<geometry::Triangle> triangles)
{
    FilmTopology out;
    std::vector<std::vector<int>> beside(static_cast<std::size_t>(vertices));
    for (const geometry::Triangle& t : triangles)
        for (int k = 0; k < 3; ++k) {
            beside[t[k]].push_back(t[(k + 1) % 3]);
            beside[t[(k + 1) % 3]].push_back(t[k]);
        }
    out.first.assign(1, 0);
    for (auto& list : beside) {
        std::ranges::sort(list);
        list.erase(std::unique(list.begin(), list.end()), list.end());
        out.next.insert(out.next.end(), list.begin(), list.end());
        out.first.push_back(static_cast<int>(out.next.size()));
    }
    const auto slot = [&](int a, int b) {
        const auto from = out.next.begin() + out.first[a], to = out.next.begin() + out.first[a + 1];
        return static_cast<int>(std::lower_bound(from, to, b) - out.next.begin());
    };
    std::vector<int> uses(out.next.size(), 0);
    for (const geometry::Triangle& t : triangles) {
        std::array<int, 6> slots{};
        for (int k = 0; k < 3; ++k) {
            slots[2 * k] = slot(t[k], t[(k + 1) % 3]);
            slots[2 * k + 1] = slot(t[(k + 1) % 3], t[k]);
            ++uses[slots[2 * k]];
            ++uses[slots[2 * k + 1]];
        }
        out.slots.push_back(slots);
    }
    for (const std::array<int, 6>& slots : out.slots) {
        std::uint8_t bits = 0;
        for (int k = 0; k < 3; ++k) bits |= static_cast<std::uint8_t>(uses[slots[2 * k]] == 1 ? 1 << k : 0);
        out.rim.push_back(bits);
    }
    out.triangles = std::move(triangles);
    return out;
}

void measure(const FilmTopology& topology, std::span<const Vec3> positions, Vec3 gravity, FilmGeometry& out)
{
    const auto count = static_cast<std::size_t>(topology.vertices());
    const Vec3 up = normalized(-gravity);
    out.gravity = length(gravity);
    out.area.assign(count, 0.0);
    out.upward.assign(count, 0.0);
    out.rim.assign(count, 0.0);
    out.conductance.assign(topology.next.size(), 0.0);
    out.elevation.resize(count);
    for (std::size_t v = 0; v < count; ++v) out.elevation[v] = dot(up, positions[v]);
    for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
        const geometry::Triangle& corners = topology.triangles[t];
        const std::array<Vec3, 3> p{positions[corners[0]], positions[corners[1]], positions[corners[2]]};
        const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
        const double twice = length(normal);
        if (!(twice > 1e-30) || !std::isfinite(twice)) continue; // no area: nothing lies on it or passes it
        const Vec3 downhill = dot(up, normal) / (twice * twice) * normal - up; // slope of the elevation, downwards
        for (int k = 0; k < 3; ++k) {
            const Vec3 a = p[k], b = p[(k + 1) % 3], c = p[(k + 2) % 3];
            out.area[corners[k]] += twice / 6.0;
            out.upward[corners[k]] += dot(up, normal);
            // Half the cotangent of the angle opposite the edge: the width of the dual face over the edge's length.
            const double half = 0.5 * dot(a - c, b - c) / twice;
            out.conductance[topology.slots[t][2 * k]] += half;
            out.conductance[topology.slots[t][2 * k + 1]] += half;
            if ((topology.rim[t] >> k & 1) == 0) continue;
            const double fall = std::max(dot(downhill, cross(b - a, normal) / twice), 0.0);
            out.rim[corners[k]] += 0.5 * fall;
            out.rim[corners[(k + 1) % 3]] += 0.5 * fall;
        }
    }
    for (double& each : out.conductance) each = std::max(each, 0.0); // obtuse pairs of triangles: no flow uphill
    // The sum of cosines times areas, over the sum of areas; 6 area = sum of 2 areas of triangles.
    for (std::size_t v = 0; v < count; ++v)
        if (out.area[v] > 0.0) out.upward[v] = std::clamp(out.upward[v] / (6.0 * out.area[v]), -1.0, 1.0);
}

double flow(const FilmTopology& topology, const FilmGeometry& geometry, const FilmLiquid& liquid, double dt,
            FilmContent& content, std::vector<int>& order)
{
    order.clear();
    for (int v = 0; v < topology.vertices(); ++v)
        if (geometry.area[v] > 0.0) order.push_back(v);
    Pass pass{topology, geometry, liquid, dt, std::vector<double>(content.volume.size())};
    for (int v = 0; v < topology.vertices(); ++v) pass.levels[v] = level(geometry, content, v);
    // From the highest down, so that each vertex has all that comes to it before it gives: implicit in one pass.
    std::ranges::sort(order, [&levels = pass.levels](int a, int b) {
        return levels[a] != levels[b] ? levels[a] > levels[b] : a < b;
    });
    double dripped = 0.0;
    for (const int v : order) dripped += giveDown(pass, v, content);
    for (const int v : order) dripped += drip(pass, v, content);
    for (std::size_t v = 0; v < content.volume.size(); ++v) content.aged[v] += dt * content.volume[v];
    return dripped;
}

} // namespace filasofia::surface
