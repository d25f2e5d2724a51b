#include "filasofia/physics/rod_body_def.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/physics/check_line.h"
#include "filasofia/physics/defs.h"

#include <algorithm>
#include <cmath>

namespace filasofia::physics {
namespace {

constexpr std::size_t kMinNodes = 3, kMaxNodes = 100000;
constexpr std::size_t kMinRing = 8; // with fewer, the ends of the band matrix would meet (linalg/band_matrix.h)
constexpr double kSharpest = -0.98; // [-] cosine of 168 degrees: at 180 degrees a fold has no direction

/// Points at equal distances along the line through these corners.
std::vector<Vec3> resampled(const std::vector<Vec3>& corners, std::size_t edges, double whole)
{
    std::vector<Vec3> nodes{corners.front()};
    std::size_t corner = 0;
    double before = 0.0; // length of the line up to that corner
    for (std::size_t i = 1; i < edges; ++i) {
        const double at = whole * static_cast<double>(i) / static_cast<double>(edges);
        double side = distance(corners[corner], corners[corner + 1]);
        for (; at > before + side && corner + 2 < corners.size(); side = distance(corners[corner], corners[corner + 1]))
            before += side, ++corner;
        nodes.push_back(corners[corner] +
                        std::min(1.0, (at - before) / side) * (corners[corner + 1] - corners[corner]));
    }
    nodes.push_back(corners.back());
    return nodes;
}

} // namespace

void checkLine(std::span<const Vec3> points, bool closed, const std::string& object, const char* list)
{
    const std::size_t count = points.size(), edges = closed ? count : count - 1;
    for (std::size_t i = 0; i < edges; ++i)
        if (const std::size_t k = (i + 1) % count; !(distance(points[i], points[k]) > 0.0))
            fail(object, ": ", list, "[", i, "] and ", list, "[", k, "] must be apart, their distance is 0 m");
    for (std::size_t i = closed ? 0 : 1; i < edges; ++i) {
        const Vec3 e = points[i] - points[(i + count - 1) % count], f = points[(i + 1) % count] - points[i];
        if (const double cosine = dot(e, f) / (length(e) * length(f)); !(cosine > kSharpest))
            fail(object, ": the line must turn by less than 168 degrees at ", list, "[", i, "], turns by ",
                 std::acos(std::max(-1.0, cosine)) * 57.29577951308232, " degrees");
    }
}

std::vector<Vec3> centreLine(const RodBodyDef& def)
{
    const std::string object = text("rod '", def.name, "'");
    const Pose pose = unitPose(def.pose, object + ": pose");
    if (def.points.size() < 2) fail(object, ": points must have at least 2 entries, got ", def.points.size());
    std::vector<Vec3> nodes;
    double whole = 0.0;
    for (std::size_t i = 0; i < def.points.size(); ++i) {
        const Vec3 p = transform(pose, def.points[i]);
        if (!(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest))
            fail(object, ": points[", i, "] must lie within ", kFarthest, " m of the origin, got ", p.x, " ", p.y, " ",
                 p.z);
        if (!nodes.empty()) whole += distance(nodes.back(), p);
        nodes.push_back(p);
    }
    if (def.closed && nodes.size() < kMinNodes)
        fail(object, ": points must have at least ", kMinNodes, " entries for a ring, got ", nodes.size());
    checkLine(nodes, def.closed, object, "points");
    const std::size_t fewest = def.closed ? kMinRing : kMinNodes;
    if (def.spacing) {
        if (def.closed) {
            whole += distance(nodes.back(), nodes.front());
            nodes.push_back(nodes.front());
        }
        if (!(*def.spacing < whole))
            fail(object, ": spacing must be < the rod's length, ", whole, " m, got ", *def.spacing);
        const double edges =
            std::max(static_cast<double>(def.closed ? kMinRing : kMinNodes - 1), std::round(whole / *def.spacing));
        if (!(edges < static_cast<double>(kMaxNodes)))
            fail(object, ": spacing must leave at most ", kMaxNodes, " nodes, got ", *def.spacing, " m on ", whole,
                 " m");
        nodes = resampled(nodes, static_cast<std::size_t>(edges), whole);
        if (def.closed) nodes.pop_back();
        checkLine(nodes, def.closed, object, "nodes");
    }
    if (nodes.size() < fewest || nodes.size() > kMaxNodes)
        fail(object, ": points must be in [", fewest, ", ", kMaxNodes, "] without a spacing, got ", nodes.size());
    return nodes;
}

} // namespace filasofia::physics
