#include "filasofia/geometry/knot_determinant.h"

#include "filasofia/math/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace filasofia::geometry {

int knotDeterminant(std::vector<Vec3> line)
{
    const Quat turned = axisAngle({0.6, 0.8, 0.0}, 0.05); // no two points lie behind one another
    for (Vec3& point : line) point = rotate(turned, point);
    std::vector<std::array<double, 2>> crossings; // where on the line it passes below, and above
    const std::size_t n = line.size();
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i + 2; k < n; ++k) {
            const Vec3 p = line[i], d = line[(i + 1) % n] - p, q = line[k], e = line[(k + 1) % n] - q;
            const double area = d.x * e.y - d.y * e.x;
            if (area == 0.0 || (i == 0 && k == n - 1)) continue;
            const double t = ((q.x - p.x) * e.y - (q.y - p.y) * e.x) / area;
            const double s = ((q.x - p.x) * d.y - (q.y - p.y) * d.x) / area;
            if (t < 0.0 || t >= 1.0 || s < 0.0 || s >= 1.0) continue;
            std::array<double, 2> both{static_cast<double>(i) + t, static_cast<double>(k) + s};
            if (p.z + t * d.z > q.z + s * e.z) std::swap(both[0], both[1]);
            crossings.push_back(both);
        }
    if (crossings.size() < 2) return 1;
    std::ranges::sort(crossings);
    const std::size_t m = crossings.size();
    std::vector<std::vector<double>> rows(m, std::vector<double>(m, 0.0));
    for (std::size_t j = 0; j < m; ++j) {
        const auto after = std::ranges::lower_bound(crossings, crossings[j][1], {}, [](const auto& c) { return c[0]; });
        rows[j][static_cast<std::size_t>(after - crossings.begin()) % m] += 2.0;
        rows[j][j] -= 1.0;
        rows[j][(j + 1) % m] -= 1.0;
    }
    double product = 1.0; // the pivots', without the last row and column
    for (std::size_t c = 0; c + 1 < m; ++c) {
        std::size_t best = c;
        for (std::size_t r = c; r + 1 < m; ++r)
            if (std::abs(rows[r][c]) > std::abs(rows[best][c])) best = r;
        std::swap(rows[c], rows[best]);
        product *= rows[c][c];
        if (rows[c][c] == 0.0) return 0;
        for (std::size_t r = c + 1; r + 1 < m; ++r) {
            const double share = rows[r][c] / rows[c][c];
            for (std::size_t k = c; k + 1 < m; ++k) rows[r][k] -= share * rows[c][k];
        }
    }
    return static_cast<int>(std::lround(std::abs(product)));
}

int knotDeterminantOpen(std::span<const Vec3> line, Vec3 across, Vec3 up)
{
    if (line.size() < 2) return 1;
    const Vec3 front = cross(across, up);
    std::vector<Vec3> closed;
    double size = 0.0;
    for (Vec3 each : line) {
        const Vec3 arm = each - line.front();
        closed.push_back({dot(arm, across), dot(arm, up), dot(arm, front)});
        size = std::max(size, length(arm));
    }
    const Vec3 first = closed.front(), last = closed.back();
    const double out = (last.x > first.x ? 20.0 : -20.0) * size, over = 0.4 * size, above = 60.0 * size;
    closed.push_back({out, std::max(last.y, over), last.z});
    closed.push_back({out, above, 0.0});
    closed.push_back({-out, above, 0.0});
    closed.push_back({-out, std::max(first.y, over), first.z});
    return knotDeterminant(std::move(closed));
}

} // namespace filasofia::geometry
