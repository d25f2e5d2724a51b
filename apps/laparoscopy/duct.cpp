#include "apps/laparoscopy/duct.h"

#include <filasofia/core/random.h>

#include "apps/laparoscopy/box.h"

using namespace filasofia;

namespace cannulating {
namespace {

constexpr double kBefore = -10_mm, kBehind = 40_mm, kCell = 2_mm; // the duct's ends, and its cells along it
constexpr double kTable = -8_mm, kHeight = 14_mm;                 // heights: the table, the duct's middle
constexpr double kSlope = 30_deg;                                 // the introducer's; it points to the opening
constexpr double kStart = 20_mm, kMouth = 56_mm, kRear = 80_mm, kEnd = 116_mm; // along that line: tip, introducer, end
constexpr double kBore = 1.3_mm, kTube = 2.2_mm;                               // radii of the introducer
constexpr double kSpacing = 1.5_mm;

Vec3 onLine(double back) { return {-back * std::cos(kSlope), kLumen + back * std::sin(kSlope), 0}; }

/// Turns y into a unit vector.
Quat upright(Vec3 to) { return axisAngle(cross({0, 1, 0}, to), std::acos(std::clamp(to.y, -1.0, 1.0))); }

void addWall(Simulation& sim, Duct& duct)
{
    const auto mesh = std::make_shared<const TetMesh>(loadTetMesh(asset("meshes/laparoscopy/duct.msh")));
    SoftBodyDef def{.name = "duct", .mesh = mesh, .pose = duct.pose, .friction = 0.1, .dynamicTopology = true};
    def.material = FemMaterial{.youngModulus = 100_kPa, .poissonRatio = 0.4, .tearingThreshold = 100_kPa};
    def.rayleigh = {20.0, 2e-3};
    def.collision = {{.proximity = 0.2_mm}};
    AttachmentDef ends;
    duct.rings.resize(static_cast<std::size_t>(std::lround((kBehind - kBefore) / kCell)) + 1);
    for (std::size_t i = 0; i < mesh->nodes.size(); ++i) {
        const Vec3& node = mesh->nodes[i];
        if (node.x < kBefore + 0.5 * kCell || node.x > kBehind - 0.5 * kCell) ends.nodes.push_back(static_cast<int>(i));
        if (std::hypot(node.y, node.z) > kLumen + 0.5 * kWall) continue;
        duct.rings[static_cast<std::size_t>(std::lround((node.x - kBefore) / kCell))].push_back(static_cast<int>(i));
    }
    def.attachments = {ends};
    duct.wall = sim.add(def);
    sim.show(duct.wall,
             {.subdivision = 1, .material = TissueMaterial{.baseColor = {0.72, 0.42, 0.30}, .vessels = 0.2}});

    const double bottom = kTable - kHeight, top = -kLumen - kWall - 0.5_mm;
    RigidBodyDef posts{.name = "posts", .elements = {}}, caps{.name = "caps", .elements = {}};
    for (const double x : {kBefore + 2_mm, kBehind - 2_mm})
        posts.elements.push_back(duct.pose * Pose{{x, 0.5 * (bottom + top), 0}});
    for (const double x : {kBefore - 0.8_mm, kBehind + 0.8_mm})
        caps.elements.push_back(duct.pose * Pose{{x, 0, 0}, axisAngle({0, 0, 1}, 90_deg)});
    posts.mesh = shapes::box({6_mm, top - bottom, 11_mm});
    caps.mesh = shapes::cylinder(kLumen + kWall, 1_mm, 6);
    const TissueMaterial grey = laparoscopy::plain({0.16, 0.20, 0.24}, 0.0);
    for (RigidBodyDef* each : {&posts, &caps}) {
        for (int i = 0; i < 2; ++i) each->collision.push_back({.element = i, .proximity = 0.2_mm});
        sim.show(sim.add(*each), {.material = grey});
    }
}

void addCatheter(Simulation& sim, Duct& duct, const Pose& stand)
{
    const Quat back = stand.orientation * upright(normalized(onLine(1) - onLine(0)));
    const auto tube = [](int around) {
        constexpr double kLength = kRear - kMouth;
        return shapes::revolved(
            {{kBore + 0.6_mm, 0, 0}, {kTube, 0.4_mm, 0}, {kTube, kLength, 0}, {kBore, kLength, 0}, {kBore, 0.6_mm, 0}},
            around);
    };
    RigidBodyDef introducer{.name = "introducer", .elements = {{transform(stand, onLine(kMouth)), back}}};
    introducer.mesh = tube(10);
    introducer.collision = {{.primitives = {.points = false, .lines = false}, .proximity = 0.2_mm}};
    introducer.friction = 2.0; // its seal: what was left there stays
    sim.show(sim.add(introducer), {.surface = tube(32), .material = laparoscopy::plain({0.55, 0.57, 0.60}, 0.3)});

    RodBodyDef def{.name = "catheter", .points = {onLine(kEnd), onLine(kStart)}, .spacing = kSpacing, .pose = stand};
    def.radius = kCatheter;
    def.youngModulus = 15_MPa;
    def.rayleigh = {20.0, 2e-3};
    def.friction = 0.3;
    def.collision = RodCollision{.proximity = 0.2_mm, .self = false};
    duct.catheter = sim.add(def);
    sim.show(duct.catheter, {.material = laparoscopy::plain({0.75, 0.72, 0.60}, 0.3)});

    RigidBodyDef marks{.name = "marks", .elements = {}};
    for (const double mark : kMarks) marks.elements.push_back({transform(stand, onLine(kStart + mark)), back});
    marks.mesh = shapes::cylinder(kCatheter + 0.06_mm, 1_mm, 6);
    duct.marks = sim.add(marks);
    sim.show(duct.marks, {.material = laparoscopy::plain({0.01, 0.01, 0.01}, 0.0)});
    sim.everyStep([&sim, duct](double) {
        const FrameRef now = sim.physics().latest();
        for (int i = 0; now && i < 2; ++i)
            sim.physics().setPose(duct.marks, {duct.at(*now, kMarks[i]), upright(duct.forward(*now, kMarks[i]))}, i);
    });
}

} // namespace

Place Duct::place(const frame::Frame& now, Vec3 point) const
{
    const auto& x = now.softBody(wall)->positions;
    const auto middle = [&](std::size_t ring) {
        Vec3 sum;
        for (const int node : rings[ring]) sum += x[static_cast<std::size_t>(node)];
        return 1.0 / static_cast<double>(rings[ring].size()) * sum;
    };
    Place nearest{.away = 1.0};
    for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
        const Vec3 from = middle(i), step = middle(i + 1) - from;
        const double part = std::clamp(dot(point - from, step) / dot(step, step), 0.0, 1.0);
        const double away = distance(point, from + part * step);
        if (away < nearest.away) nearest = {kBefore + (static_cast<double>(i) + part) * kCell, away};
    }
    return nearest;
}
Vec3 Duct::tip(const frame::Frame& now) const { return now.softBody(catheter)->positions.back(); }
Vec3 Duct::at(const frame::Frame& now, double behind) const
{
    const auto& x = now.softBody(catheter)->positions;
    const double part = static_cast<double>(x.size() - 1) - behind / kSpacing;
    const auto first = static_cast<std::size_t>(std::clamp(part, 0.0, static_cast<double>(x.size() - 2)));
    return x[first] + (part - static_cast<double>(first)) * (x[first + 1] - x[first]);
}
Vec3 Duct::forward(const frame::Frame& now, double behind) const
{
    return normalized(at(now, behind - 0.5 * kSpacing) - at(now, behind + 0.5 * kSpacing));
}
double Duct::depth(const frame::Frame& now) const
{
    const auto& x = now.softBody(catheter)->positions;
    for (auto node = x.rbegin(); node != x.rend(); ++node) {
        const Place is = place(now, *node);
        if (is.away > kOutside) return 0.0;
        if (is.along < 0.5 * kOpening) return std::max(0.0, place(now, x.back()).along);
    }
    return 0.0;
}

Duct addDuct(Simulation& sim, std::uint64_t seed)
{
    Random random(seed);
    Duct duct;
    const Pose stand{{8_mm, kHeight, 4_mm}, axisAngle({0, 1, 0}, 205_deg)};
    const Vec3 shift{random.between(-3_mm, 3_mm), random.between(-2_mm, 2_mm), random.between(-3_mm, 3_mm)};
    duct.pose = stand * Pose{shift, axisAngle({0, 1, 0}, random.between(-8_deg, 8_deg))};
    addWall(sim, duct);
    addCatheter(sim, duct, stand);
    RigidBodyDef table{
        .name = "table", .elements = {{{0, kTable - 5_mm, 0}, {}}}, .mesh = shapes::box({600_mm, 10_mm, 500_mm})};
    table.collision = {{.proximity = 0.2_mm}};
    sim.show(sim.add(table), {.material = laparoscopy::plain({0.05, 0.16, 0.20}, 0.0)});
    return duct;
}

} // namespace cannulating
