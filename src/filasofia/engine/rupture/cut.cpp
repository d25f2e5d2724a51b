#include "filasofia/engine/rupture/cut.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/math/mat3.h"

#include <cmath>

namespace filasofia::engine {
namespace {

/// n ~ F^-T n_rest over the node's elements. It uses cofactors, so it is defined even if an element is flat.
Vec3 normalNow(const MeshTopology& mesh, int node, Vec3 rest)
{
    Vec3 sum;
    for (int t : mesh.around[node]) {
        const auto p = solidCorners(mesh.tetrahedra[t], mesh.rest), x = solidCorners(mesh.tetrahedra[t], mesh.current);
        const Mat3 f = Mat3::columns(x[1] - x[0], x[2] - x[0], x[3] - x[0]) *
                       inverse(Mat3::columns(p[1] - p[0], p[2] - p[0], p[3] - p[0]));
        const Vec3 a = f.column(0), b = f.column(1), c = f.column(2);
        sum += Mat3::columns(cross(b, c), cross(c, a), cross(a, b)) * rest;
    }
    return normalized(sum);
}

} // namespace

RuptureReport BladeStroke::step(EditableMesh& mesh, std::span<const BladeSegment> blade,
                                const CutParameters& parameters)
{
    RuptureReport report;
    if (const auto refusal = refusalOf(blade, mesh.diagonal())) {
        ++report.refused[static_cast<int>(*refusal)];
        report.pending = static_cast<long>(crossings_.size());
        return report;
    }
    const std::size_t waiting = crossings_.size();
    finder_.find(mesh, blade, crossings_);
    report.crossings = static_cast<long>(crossings_.size() - waiting);
    cutCrossings(mesh, sheet_, parameters, finder_.runs(), crossings_, report);
    finder_.addEdgesOfNewNodes(mesh);
    report.pending = static_cast<long>(crossings_.size());
    return report;
}

int sheetAt(const EditableMesh& mesh, std::span<const BladeSegment> blade)
{
    constexpr double kInPlane = 0.5; // sine of 30 degrees
    const MeshTopology& data = mesh.data();
    const CutLabel* newest = nullptr;
    for (int node = 0; node < mesh.nodes(); ++node) {
        const CutLabel& label = data.labels[node];
        if (label.sheet == 0 || (newest && label.sequence <= newest->sequence)) continue;
        for (const BladeSegment& s : blade) {
            const Vec3 at = geometry::nearestOnSegment(data.current[node], s.from, s.to).point;
            if (distance(at, data.current[node]) > mesh.meanEdge()) continue;
            const Vec3 normal = normalNow(data, node, label.normal);
            if (std::abs(dot(normal, normalized(s.to - s.from))) <= kInPlane) newest = &label;
        }
    }
    return newest ? newest->sheet : 0;
}

bool BladeStroke::finish(EditableMesh& mesh, const CutParameters& parameters, RuptureReport& report)
{
    cutCrossings(mesh, sheet_, parameters, finder_.runs(), crossings_, report);
    report.pending = static_cast<long>(crossings_.size());
    if (!crossings_.empty()) return false;
    openAll(mesh, openingLimits(parameters, mesh.meanEdge()), report);
    return true;
}

} // namespace filasofia::engine
