#include "apps/laparoscopy/gauze.h"

#include <filasofia/core/disjoint_sets.h>
#include <filasofia/core/random.h>

#include <map>
#include <numbers>

using namespace filasofia;

namespace cutting {
namespace {

constexpr int kCells = 28;       // along each side
constexpr double kCorner = 6e-3; // [m] that a clip holds
constexpr double kNear = 5e-3;   // [m] from the circle
constexpr int kSectors = 120;    // around the circle
constexpr int kParts = 8;        // along a triangle's edges, to measure its part of the disc

/// The nodes at a corner.
AttachmentDef clipAt(const TriangleMesh& mesh, double x, double z)
{
    AttachmentDef clip;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3 v = mesh.vertices[i];
        if (x * v.x > 0.5 * kSide - kCorner && z * v.z > 0.5 * kSide - kCorner)
            clip.nodes.push_back(static_cast<int>(i));
    }
    return clip;
}

/// [m^2] The part of a triangle inside the circle.
double insideOf(Vec3 a, Vec3 b, Vec3 c)
{
    const double area = 0.5 * length(cross(b - a, c - a));
    const double far = std::max({length(a), length(b), length(c)});
    if (far < kRadius) return area;
    if (std::min({length(a), length(b), length(c)}) > kRadius + kSide / kCells) return 0.0;
    int inside = 0;
    for (int i = 0; i < kParts; ++i)
        for (int j = 0; i + j < kParts; ++j)
            for (const double third : {1.0 / 3.0, 2.0 / 3.0}) { // the small triangle, and the one turned over
                const double u = (i + third) / kParts, v = (j + third) / kParts;
                if (u + v < 1.0) inside += length(a + u * (b - a) + v * (c - a)) < kRadius;
            }
    return area * inside / (kParts * kParts);
}

} // namespace

Vec3 Gauze::at(const FrameRef& frame, double x, double z) const
{
    const Vec3 place = transform(pose, {x, 0, z});
    const frame::SoftBodyFrame* now = frame ? frame->softBody(body) : nullptr;
    if (now == nullptr) return place;
    // Before the first cut the mesh is the sheet as it was made.
    static const auto sheet = shapes::sheet(kSide, kSide, {kCells, kCells});
    const bool cut = now->boundary && now->boundary->revision > 0;
    const auto& triangles = cut ? now->boundary->triangles : sheet->triangles;
    const Pose back = inverse(pose);
    for (const auto& t : triangles) {
        std::array<Vec3, 3> rest;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto node = static_cast<std::size_t>(t[k]);
            rest[k] = cut ? transform(back, now->boundary->rest[node]) : sheet->vertices[node];
        }
        const auto side = [&](std::size_t k) {
            const Vec3 p = rest[(k + 1) % 3], q = rest[(k + 2) % 3];
            return (p.z - z) * (q.x - x) - (p.x - x) * (q.z - z);
        };
        const std::array w = {side(0), side(1), side(2)};
        const double sum = w[0] + w[1] + w[2];
        if (!(sum > 0.0) || std::min({w[0], w[1], w[2]}) < -1e-9 * sum) continue;
        Vec3 out;
        for (std::size_t k = 0; k < 3; ++k) out += w[k] / sum * now->positions[static_cast<std::size_t>(t[k])];
        return out;
    }
    return place;
}

Vec3 Gauze::normalAt(const FrameRef& frame, double x, double z) const
{
    constexpr double kStep = 2e-3;
    const Vec3 right = at(frame, x + kStep, z) - at(frame, x - kStep, z);
    const Vec3 back = at(frame, x, z - kStep) - at(frame, x, z + kStep);
    return normalized(cross(right, back));
}

Gauze addGauze(Simulation& sim, std::uint64_t seed)
{
    Random random(seed);
    Gauze gauze;
    const Vec3 place{random.between(-4_mm, 4_mm), 46_mm + random.between(-3_mm, 3_mm), random.between(-4_mm, 4_mm)};
    const Quat tilted = axisAngle({1, 0, 0}, random.between(-4_deg, 4_deg));
    gauze.pose = {place, axisAngle({0, 1, 0}, random.between(-6_deg, 6_deg)) * tilted};
    const auto mesh = shapes::sheet(kSide, kSide, {kCells, kCells}, true);
    SoftBodyDef cloth{.name = "gauze", .mesh = mesh, .pose = gauze.pose};
    cloth.material =
        ShellMaterial{.youngModulus = 200e3, .poissonRatio = 0.2, .thickness = 0.4_mm, .bendingScale = 30.0};
    cloth.mass = Density{80.0}; // 32 g/m^2, as gauze of one or two layers
    cloth.rayleigh = {8.0, 1e-3};
    cloth.attachments = {clipAt(*mesh, -1, -1), clipAt(*mesh, 1, -1), clipAt(*mesh, 1, 1)};
    cloth.collision = {{.proximity = 0.5_mm, .group = LeftTool}, {.proximity = 0.5_mm, .group = RightTool}};
    cloth.dynamicTopology = true;
    cloth.friction = 0.8;
    gauze.body = sim.add(cloth);
    sim.show(gauze.body,
             {.material = TissueMaterial{.roughness = 0.95,
                                         .wetness = 0.0,
                                         .thickness = 0.2,
                                         .mottling = 0.0,
                                         .vessels = 0.0,
                                         .bump = 0.0,
                                         .baseColorTexture = TextureFile{asset("meshes/laparoscopy/gauze.png")}}});
    for (const auto& [x, z] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}}) {
        const double reach = 0.5 * kSide + 6_mm;
        RigidBodyDef clip{.name = text("clip at ", x < 0 ? "the left" : "the right", z < 0 ? " back" : " front")};
        clip.elements = {{transform(gauze.pose, {x * reach, 0, z * reach}),
                          gauze.pose.orientation * axisAngle({0, 1, 0}, x * z > 0 ? 45_deg : -45_deg)}};
        clip.mesh = shapes::box({5_mm, 3_mm, 22_mm});
        sim.show(sim.add(clip), {.material = MetalMaterial{.roughness = 0.35}});
    }
    RigidBodyDef table{
        .name = "table", .elements = {{{0, -13_mm, 0}, {}}}, .mesh = shapes::box({600_mm, 10_mm, 500_mm})};
    sim.show(sim.add(table), {.material = TissueMaterial{.baseColor = {0.05, 0.16, 0.20},
                                                         .subsurfaceColor = {0.05, 0.16, 0.20},
                                                         .wetness = 0.0,
                                                         .thickness = 0.0,
                                                         .mottling = 0.0,
                                                         .vessels = 0.0}});
    return gauze;
}

CutPattern patternOf(const Gauze& gauze, const frame::SoftBodyFrame& body)
{
    CutPattern out;
    if (!body.boundary || body.boundary->revision == 0) return out;
    const Pose back = inverse(gauze.pose);
    std::vector<Vec3> rest;
    for (const Vec3& each : body.boundary->rest) rest.push_back(transform(back, each));
    const auto at = [&](int node) { return rest[static_cast<std::size_t>(node)]; };
    const auto onRim = [&](int node) {
        return std::max(std::abs(at(node).x), std::abs(at(node).z)) > 0.5 * kSide - 1e-6;
    };

    DisjointSets pieces(rest.size());
    std::map<std::pair<int, int>, int> edges;
    int middle = -1;
    for (const auto& t : body.boundary->triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            pieces.join(a, b);
            ++edges[{std::min(a, b), std::max(a, b)}];
            if (middle < 0 || length(at(a)) < length(at(middle))) middle = a;
        }
    std::array<bool, kSectors> cut{};
    for (const auto& [edge, count] : edges) {
        const auto& [a, b] = edge;
        if (count != 1 || (onRim(a) && onRim(b))) continue;
        for (int i = 0; i <= 8; ++i) { // an edge may pass several sectors
            const Vec3 p = at(a) + i / 8.0 * (at(b) - at(a));
            const auto sector = static_cast<int>((std::atan2(p.x, p.z) / (2.0 * std::numbers::pi) + 0.5) * kSectors);
            if (std::abs(length(p) - kRadius) < kNear)
                cut[static_cast<std::size_t>(std::clamp(sector, 0, kSectors - 1))] = true;
        }
    }
    out.around = static_cast<double>(std::ranges::count(cut, true)) / kSectors;
    out.out = middle >= 0 && std::ranges::none_of(body.boundary->triangles, [&](const auto& t) {
                  return pieces.find(t[0]) == pieces.find(middle) && std::ranges::any_of(t, onRim);
              });
    if (!out.out) return out;
    double inside = 0.0, outside = 0.0; // [m^2] what the piece has there
    for (const auto& [a, b, c] : body.boundary->triangles) {
        if (pieces.find(a) != pieces.find(middle)) continue;
        const double in = insideOf(at(a), at(b), at(c));
        inside += in;
        outside += 0.5 * length(cross(at(b) - at(a), at(c) - at(a))) - in;
    }
    out.deviation = outside + std::max(0.0, std::numbers::pi * kRadius * kRadius - inside);
    return out;
}

} // namespace cutting
