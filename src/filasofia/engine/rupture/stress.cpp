#include "filasofia/engine/rupture/stress.h"

#include "filasofia/geometry/tet_mesh.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {

PrincipalStress principalStress(const Mat3& stress)
{
    constexpr int kSweeps = 20; // five or six are enough
    double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) a[r][c] = 0.5 * (stress[r][c] + stress[c][r]);
    for (int sweep = 0; sweep < kSweeps && (a[0][1] != 0.0 || a[0][2] != 0.0 || a[1][2] != 0.0); ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                if (a[p][q] == 0.0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
                const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 3; ++k) {
                    const double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
                a[p][q] = a[q][p] = 0.0;
                for (int k = 0; k < 3; ++k) {
                    const double x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y;
                    v[k][q] = s * x + c * y;
                }
            }
    int principal = 0;
    for (int i = 1; i < 3; ++i)
        if (a[i][i] > a[principal][principal]) principal = i;
    Vec3 d = normalized(Vec3{v[0][principal], v[1][principal], v[2][principal]}, {1, 0, 0});
    int largest = 0;
    for (int i = 1; i < 3; ++i)
        if (std::abs(d[i]) > std::abs(d[largest])) largest = i;
    if (d[largest] < 0.0) d = -d;
    return {a[principal][principal], d};
}

double principalStressBound(const Mat3& stress)
{
    const double mean = trace(stress) / 3.0;
    return mean + std::sqrt(2.0 / 3.0) * frobeniusNorm(stress - Mat3::diagonal({mean, mean, mean}));
}

Mat3 virialStress(const std::array<Vec3, 4>& corners, const std::array<double, 6>& tensions)
{
    const double volume = geometry::signedVolume(corners[0], corners[1], corners[2], corners[3]);
    Mat3 sum;
    double longest = 0.0;
    for (int e = 0; e < 6; ++e) {
        const auto [i, j] = geometry::kTetrahedronEdges[e];
        const Vec3 d = corners[j] - corners[i];
        const double l = length(d);
        longest = std::max(longest, l);
        if (l > 0.0) sum += (tensions[e] / l) * outer(d, d);
    }
    if (!(volume > 1e-9 * longest * longest * longest)) return {};
    return (1.0 / volume) * sum;
}

} // namespace filasofia::engine
