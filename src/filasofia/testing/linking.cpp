#include "filasofia/testing/linking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace filasofia::testing {
namespace {

constexpr std::size_t kGroup = 8; ///< edges whose box is tested before theirs

/// An edge of a line before and after the step.
struct MovedEdge {
    std::array<Vec3, 2> from, to;

    [[nodiscard]] Vec3 end(std::size_t k, double t) const { return from[k] + t * (to[k] - from[k]); }
};

std::size_t edgesOf(const MovedLine& line)
{
    return line.before.empty() ? 0 : line.before.size() - (line.closed ? 0 : 1);
}

MovedEdge edgeOf(const MovedLine& line, std::size_t e)
{
    const std::size_t next = e + 1 == line.before.size() ? 0 : e + 1;
    return {{line.before[e], line.before[next]}, {line.after[e], line.after[next]}};
}

/// Six times the volume of the tetrahedron of both edges: it changes its sign where their lines cross.
double volumeAt(const MovedEdge& one, const MovedEdge& two, double t)
{
    const Vec3 a = one.end(0, t), c = two.end(0, t);
    return dot(cross(one.end(1, t) - a, two.end(1, t) - c), c - a);
}

/// Whether the edges, and not only their lines, meet at that time.
bool meetAt(const MovedEdge& one, const MovedEdge& two, double t)
{
    const Vec3 a = one.end(0, t), c = two.end(0, t), u = one.end(1, t) - a, v = two.end(1, t) - c, r = c - a;
    const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
    const double area = uu * vv - uv * uv;
    if (!(area > 1e-14 * uu * vv)) return false; // parallel edges have no crossing
    const double s = (ur * vv - uv * vr) / area, w = (ur * uv - uu * vr) / area;
    if (!(s >= 0.0 && s < 1.0 && w >= 0.0 && w < 1.0)) return false;
    return length(a + s * u - c - w * v) < 1e-4 * std::sqrt(std::min(uu, vv));
}

/// Where the cubic through the values at 0, 1/3, 2/3 and 1 has its extrema, within (0, 1), ascending.
std::vector<double> extrema(const std::array<double, 4>& f)
{
    // Newton's differences, with t in thirds.
    const double d1 = f[1] - f[0], d2 = f[2] - 2.0 * f[1] + f[0], d3 = f[3] - 3.0 * f[2] + 3.0 * f[1] - f[0];
    const double c3 = d3 / 6.0, c2 = 0.5 * d2 - 0.5 * d3, c1 = d1 - 0.5 * d2 + d3 / 3.0;
    std::vector<double> out;
    const auto keep = [&](double thirds) {
        if (thirds > 0.0 && thirds < 3.0) out.push_back(thirds / 3.0);
    };
    const double root = c2 * c2 - 3.0 * c3 * c1;
    if (root < 0.0) return out;
    const double q = -(c2 + std::copysign(std::sqrt(root), c2));
    if (c3 != 0.0) keep(q / (3.0 * c3));
    if (q != 0.0) keep(c1 / q);
    std::ranges::sort(out);
    return out;
}

/// The signed number of times that two edges crossed.
int crossings(const MovedEdge& one, const MovedEdge& two)
{
    const std::array<double, 4> f{volumeAt(one, two, 0.0), volumeAt(one, two, 1.0 / 3.0), volumeAt(one, two, 2.0 / 3.0),
                                  volumeAt(one, two, 1.0)};
    std::vector<double> times = extrema(f);
    times.push_back(1.0);
    int sum = 0;
    double low = 0.0, atLow = f[0];
    for (const double high : times) {
        const double atHigh = high == 1.0 ? f[3] : volumeAt(one, two, high);
        if ((atLow >= 0.0) != (atHigh >= 0.0)) {
            double from = low, to = high;
            for (int i = 0; i < 60; ++i) {
                const double middle = 0.5 * (from + to);
                ((volumeAt(one, two, middle) >= 0.0) == (atLow >= 0.0) ? from : to) = middle;
            }
            if (meetAt(one, two, from)) sum += atHigh >= 0.0 ? 1 : -1;
        }
        low = high;
        atLow = atHigh;
    }
    return sum;
}

} // namespace

double gaussIntegral(Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    const auto unit = [](Vec3 v) { return normalized(v, {}); };
    const Vec3 n1 = unit(cross(c - a, d - a)), n2 = unit(cross(d - a, d - b)), n3 = unit(cross(d - b, c - b)),
               n4 = unit(cross(c - b, c - a));
    const auto angle = [](Vec3 m, Vec3 n) { return std::asin(std::clamp(dot(m, n), -1.0, 1.0)); };
    const double area = angle(n1, n2) + angle(n2, n3) + angle(n3, n4) + angle(n4, n1);
    const double side = dot(cross(d - c, b - a), c - a);
    return side > 0.0 ? area : side < 0.0 ? -area : 0.0;
}

double linkingNumber(std::span<const Vec3> x, std::span<const Vec3> y)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = 0; j < y.size(); ++j)
            sum += gaussIntegral(x[i], x[(i + 1) % x.size()], y[j], y[(j + 1) % y.size()]);
    return sum / (4.0 * std::numbers::pi);
}

double writhe(std::span<const Vec3> x)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = i + 2; j < x.size(); ++j)
            if (i > 0 || j + 1 < x.size()) // neighbours have none
                sum += gaussIntegral(x[i], x[i + 1], x[j], x[(j + 1) % x.size()]);
    return sum / (2.0 * std::numbers::pi);
}

void PassCounter::bound(const MovedLine& line, Boxes& out)
{
    out.edges.clear();
    out.groups.clear();
    for (std::size_t e = 0; e < edgesOf(line); ++e) {
        const auto [from, to] = edgeOf(line, e);
        const Box box{min(min(from[0], from[1]), min(to[0], to[1])), max(max(from[0], from[1]), max(to[0], to[1]))};
        out.edges.push_back(box);
        if (e % kGroup == 0) out.groups.push_back(box);
        Box& group = out.groups.back();
        group = {min(group.low, box.low), max(group.high, box.high)};
    }
}

int PassCounter::count(const MovedLine& first, const MovedLine& second)
{
    const bool self = first.before.data() == second.before.data();
    bound(first, first_);
    if (!self) bound(second, second_);
    const Boxes& one = first_;
    const Boxes& two = self ? first_ : second_;
    const auto apart = [](const Box& a, const Box& b) {
        return a.low.x > b.high.x || b.low.x > a.high.x || a.low.y > b.high.y || b.low.y > a.high.y ||
               a.low.z > b.high.z || b.low.z > a.high.z;
    };
    const std::size_t edges = one.edges.size();
    int sum = 0;
    for (std::size_t g = 0; g < one.groups.size(); ++g)
        for (std::size_t h = self ? g : 0; h < two.groups.size(); ++h) {
            if (apart(one.groups[g], two.groups[h])) continue;
            for (std::size_t i = g * kGroup; i < std::min(edges, (g + 1) * kGroup); ++i)
                for (std::size_t k = h * kGroup; k < std::min(two.edges.size(), (h + 1) * kGroup); ++k) {
                    // Edges that share a point do not pass through each other.
                    if (self && (k < i + 2 || (first.closed && i == 0 && k + 1 == edges))) continue;
                    if (!apart(one.edges[i], two.edges[k])) sum += crossings(edgeOf(first, i), edgeOf(second, k));
                }
        }
    return sum;
}

} // namespace filasofia::testing
