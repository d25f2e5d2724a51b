#include "filasofia/surface/heat.h"

#include "filasofia/geometry/box.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::surface {
namespace {

constexpr double kGasConstant = 8.314462618; ///< [J/(mol K)]

double distanceTo(const HeatReach& reach, Vec3 p)
{
    const std::vector<Vec3>& at = reach.points;
    if (reach.filled)
        return std::sqrt(std::min(geometry::nearestOnTriangle(p, at[0], at[1], at[2]).squaredDistance,
                                  geometry::nearestOnTriangle(p, at[0], at[2], at[3]).squaredDistance));
    if (at.size() == 1) return distance(p, at[0]);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < at.size(); ++i)
        nearest = std::min(nearest, geometry::nearestOnSegment(p, at[i - 1], at[i]).squaredDistance);
    return std::sqrt(nearest);
}

/// Points of a reach without its radius, at most half of that apart, as far as the most points go.
std::vector<Vec3> pointsOf(const HeatReach& reach)
{
    constexpr int kMost = 16;
    const std::vector<Vec3>& at = reach.points;
    const auto steps = [&](double length) {
        return std::clamp(static_cast<int>(std::ceil(std::min(1.0 * kMost, 2.0 * length / reach.radius))), 1, kMost);
    };
    if (!reach.filled) {
        std::vector<Vec3> points = {at[0]};
        for (std::size_t i = 1; i < at.size(); ++i) {
            const int along = steps(distance(at[i - 1], at[i]));
            for (int k = 1; k <= along; ++k) {
                const double u = 1.0 * k / along;
                points.push_back((1.0 - u) * at[i - 1] + u * at[i]);
            }
        }
        return points;
    }
    const Vec3 a = at[0], b = at[1], c = at[2], d = at[3];
    const int along = steps(std::max(distance(a, b), distance(d, c)));
    const int across = steps(std::max(distance(a, d), distance(b, c)));
    std::vector<Vec3> points;
    for (int j = 0; j <= across; ++j)
        for (int i = 0; i <= along; ++i) {
            const double u = 1.0 * i / along, v = 1.0 * j / across;
            points.push_back((1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * d + u * c));
        }
    return points;
}

/// The part of a source that falls on one triangle, by samples a quarter of its radius apart.
class SourceOnTriangle {
public:
    SourceOnTriangle(std::span<const Vec3> positions, const geometry::Triangle& corners)
        : a_(positions[corners[0]]), b_(positions[corners[1]]), c_(positions[corners[2]])
    {
    }
    [[nodiscard]] bool mayReach(const HeatReach& reach, const geometry::Box& around) const
    {
        if (!overlap(geometry::merged(geometry::merged({a_, a_}, b_), c_), around)) return false;
        const Vec3 middle = (a_ + b_ + c_) / 3.0;
        const double size = std::max({distance(a_, middle), distance(b_, middle), distance(c_, middle)});
        return distanceTo(reach, middle) <= reach.radius + size;
    }
    /// [m^2] per corner.
    [[nodiscard]] std::array<double, 3> areas(const HeatReach& reach) const
    {
        constexpr int kMost = 16;
        std::array<double, 3> out{};
        const double edge = std::max({distance(a_, b_), distance(b_, c_), distance(c_, a_)});
        const double across = std::ceil(std::min(4.0 * edge / reach.radius, 1.0 * kMost));
        const int n = std::clamp(static_cast<int>(across), 1, kMost);
        const double area = 0.5 * length(cross(b_ - a_, c_ - a_)) / (n * n);
        for (int i = 0; i < n; ++i) // n * n triangles of the same size; two for each pair but the last
            for (int j = 0; i + j < n; ++j)
                for (int k = 1; k <= (i + j + 1 < n ? 2 : 1); ++k) {
                    const double u = (i + k / 3.0) / n, v = (j + k / 3.0) / n, w = 1.0 - u - v;
                    if (!(distanceTo(reach, w * a_ + u * b_ + v * c_) <= reach.radius)) continue;
                    out[0] += w * area;
                    out[1] += u * area;
                    out[2] += v * area;
                }
        return out;
    }
    [[nodiscard]] geometry::Nearest<3> nearest(const std::vector<Vec3>& points) const
    {
        geometry::Nearest<3> best = geometry::nearestOnTriangle(points.front(), a_, b_, c_);
        for (const Vec3& point : points)
            if (const auto here = geometry::nearestOnTriangle(point, a_, b_, c_);
                here.squaredDistance < best.squaredDistance)
                best = here;
        return best;
    }

private:
    Vec3 a_, b_, c_;
};

/// Two vertices approach their mean temperature.
void exchange(double conductance, double capacityA, double capacityB, double dt, double& a, double& b)
{
    const double sum = capacityA + capacityB;
    if (!(conductance > 0.0) || !(capacityA > 0.0) || !(capacityB > 0.0)) return;
    const double both = capacityA * capacityB / sum;
    const double heat = both * (b - a) * -std::expm1(-conductance * dt / both);
    a += heat / capacityA;
    b -= heat / capacityB;
}

} // namespace

double damageRate(double temperature, double frequencyFactor, double activationEnergy)
{
    return frequencyFactor * std::exp(-activationEnergy / (kGasConstant * temperature));
}

double damageOver(double from, double to, double dt, double frequencyFactor, double activationEnergy)
{
    const double a = damageRate(from, frequencyFactor, activationEnergy);
    const double b = damageRate(to, frequencyFactor, activationEnergy);
    const double ratio = activationEnergy / kGasConstant * (1.0 / from - 1.0 / to); // ln(b / a)
    if (std::abs(ratio) < 1e-4) return 0.5 * dt * (a + b);                          // the same up to 1e-9
    return dt * (b - a) / ratio;
}

double divideSource(std::span<const geometry::Triangle> triangles, std::span<const Vec3> positions,
                    const HeatReach& reach, std::vector<HeatShare>& out)
{
    out.clear();
    const std::vector<Vec3> points = pointsOf(reach);
    const geometry::Box around = geometry::grown(geometry::boxAround(points), reach.radius);
    std::vector<HeatShare> nearest; // where samples miss a surface that is touched: its nearest point
    double all = 0.0, closest = reach.radius * reach.radius;
    for (const geometry::Triangle& corners : triangles) {
        const SourceOnTriangle triangle(positions, corners);
        if (!triangle.mayReach(reach, around)) continue;
        const std::array<double, 3> areas = triangle.areas(reach);
        for (int k = 0; k < 3; ++k) {
            if (areas[k] > 0.0) out.push_back({corners[k], areas[k]});
            all += areas[k];
        }
        if (all > 0.0) continue;
        const geometry::Nearest<3> at = triangle.nearest(points);
        if (!(at.squaredDistance <= closest)) continue;
        closest = at.squaredDistance;
        nearest.clear();
        for (int k = 0; k < 3; ++k)
            if (at.weights[k] > 0.0) nearest.push_back({corners[k], at.weights[k]});
    }
    for (HeatShare& each : out) each.share /= all;
    if (out.empty()) out = std::move(nearest);
    return all;
}

void conduct(const FilmTopology& topology, std::span<const double> conductance, std::span<const double> capacity,
             double dt, std::vector<double>& warmth)
{
    const auto pass = [&](int v, int e) {
        const int w = topology.next[e];
        if (w > v) exchange(conductance[e], capacity[v], capacity[w], 0.5 * dt, warmth[v], warmth[w]);
    };
    for (int v = 0; v < topology.vertices(); ++v)
        for (int e = topology.first[v]; e < topology.first[v + 1]; ++e) pass(v, e);
    for (int v = topology.vertices() - 1; v >= 0; --v)
        for (int e = topology.first[v + 1] - 1; e >= topology.first[v]; --e) pass(v, e);
}

HeatedStep heatVertex(const HeatedVertex& vertex, double warmth, double power, double dt)
{
    // C d warmth / dt = power - loss * warmth, whose solution is an exponential.
    const double rate = vertex.loss / vertex.capacity, faded = -std::expm1(-rate * dt);
    const double held = rate > 0.0 ? faded / rate : dt; // [s], how long a joule at the start stays, on average
    const double left = warmth * (1.0 - faded);
    const double latent = vertex.limit > vertex.boiling ? vertex.latent : 0.0;
    const double room = std::max((vertex.limit - left) * vertex.capacity + latent, 0.0);
    const double taken = std::min(power, room / held);
    HeatedStep out{.warmth = left + taken * held / vertex.capacity, .delivered = taken * dt};
    out.lost = vertex.loss * warmth * held + taken * (dt - held);
    out.boiled = std::clamp((out.warmth - vertex.boiling) * vertex.capacity, 0.0, vertex.latent);
    out.warmth -= out.boiled / vertex.capacity;
    return out;
}

} // namespace filasofia::surface
