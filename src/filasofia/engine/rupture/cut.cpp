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

/// Whether a segment of a blade is within a mean edge of a node.
bool isNear(const EditableMesh& mesh, int node, const BladeSegment& segment)
{
    const Vec3 place = mesh.data().current[node];
    return distance(geometry::nearestOnSegment(place, segment.from, segment.to).point, place) <= mesh.meanEdge();
}
bool isInPlane(const BladeSegment& segment, Vec3 normal)
{
    constexpr double kInPlane = 0.5; // sine of 30 degrees
    return std::abs(dot(normal, normalized(segment.to - segment.from))) <= kInPlane;
}

/// Whether a blade that bends lies in a surface: nearly all of it that is near tissue. A loop whose sides follow those
/// of an older, shallower cut begins a new one.
bool liesIn(int sheet, const EditableMesh& mesh, std::span<const BladeSegment> blade)
{
    constexpr double kNearlyAll = 0.9; // [-]
    const std::vector<CutLabel>& labels = mesh.data().labels;
    double inTissue = 0.0, inSheet = 0.0; // [m]
    for (const BladeSegment& s : blade) {
        bool near = false, in = false;
        for (int node = 0; node < mesh.nodes() && !in; ++node) {
            if (!isNear(mesh, node, s)) continue;
            near = true;
            in = labels[node].sheet == sheet && isInPlane(s, normalNow(mesh.data(), node, labels[node].normal));
        }
        const double length = distance(s.from, s.to);
        if (near) inTissue += length;
        if (in) inSheet += length;
    }
    return inSheet >= kNearlyAll * inTissue;
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
    const MeshTopology& data = mesh.data();
    const CutLabel* newest = nullptr;
    Vec3 normal;
    for (int node = 0; node < mesh.nodes(); ++node) {
        const CutLabel& label = data.labels[node];
        if (label.sheet == 0 || (newest && label.sequence <= newest->sequence)) continue;
        for (const BladeSegment& s : blade) {
            if (!isNear(mesh, node, s)) continue;
            const Vec3 now = normalNow(data, node, label.normal);
            if (!isInPlane(s, now)) continue;
            newest = &label;
            normal = now;
        }
    }
    if (!newest) return 0;
    const bool straight = std::ranges::all_of(blade, [&](const BladeSegment& s) { return isInPlane(s, normal); });
    return straight || liesIn(newest->sheet, mesh, blade) ? newest->sheet : 0;
}

bool BladeStroke::finish(EditableMesh& mesh, const CutParameters& parameters, RuptureReport& report)
{
    cutCrossings(mesh, sheet_, parameters, finder_.runs(), crossings_, report);
    report.pending = static_cast<long>(crossings_.size());
    if (!crossings_.empty()) return false;
    openAll(mesh, sheet_, openingLimits(parameters, mesh.meanEdge()), report);
    return true;
}

} // namespace filasofia::engine
