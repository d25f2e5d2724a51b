#include "apps/filasofia/bench/rod_scenes.h"

#include "filasofia/core/text.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/knot_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace filasofia::app {
namespace {

namespace shapes = geometry::shapes;

constexpr double kRodEdge = 1_mm;      ///< between nodes
constexpr double kRodRadius = 0.25_mm; ///< radius of a thread that is not in tissue
constexpr int kStitchNodes = 150;
constexpr int kBlocks = 16;
constexpr double kApart = 6_mm; ///< from block to block
constexpr double kDrawn = 0.1;  ///< [m/s]

physics::RodBodyDef looseRod(const std::function<Vec3(double along)>& line, int nodes)
{
    physics::RodBodyDef def{.name = "thread", .radius = kRodRadius, .youngModulus = 1e7, .straight = false};
    for (int i = 0; i < nodes; ++i) def.points.push_back(line(kRodEdge * i));
    def.rayleigh.mass = 5.0; // so that it rests
    return def;
}

RodScene onFloor(std::string name, physics::RodBodyDef rod)
{
    rod.collision = physics::RodCollision{};
    const int nodes = static_cast<int>(rod.points.size());
    physics::RigidBodyDef floor{.name = "floor", .elements = {{{0, -5_mm, 0}, {}}}};
    floor.mesh = shapes::box({0.4, 0.01, 0.4});
    floor.collision = {{}};
    return {.scene = {.name = std::move(name), .body = "thread", .bodies = {rod, floor}, .settle = 1.0},
            .nodes = nodes};
}

/// Around the y axis, in turns.
Vec3 around(double radius, double angle, double height)
{
    return {radius * std::cos(angle), 1.2 * kRodRadius + height, radius * std::sin(angle)};
}

double turns(double angle) { return angle / (2.0 * std::numbers::pi); }

physics::SoftBodyDef skin(const std::string& name, Vec3 size, std::array<int, 3> cells, Vec3 at)
{
    physics::SoftBodyDef def{.name = name, .mesh = shapes::block(size, cells)};
    def.pose.position = at;
    def.material = physics::FemMaterial{.youngModulus = 150e3, .poissonRatio = 0.45};
    def.gravity = false;
    def.collision = {{.proximity = 0.3_mm}};
    def.puncture = physics::PunctureDef{.force = 0.25, .cutting = 0.08, .friction = 6.0};
    return def;
}

physics::RigidBodyDef needle(const std::vector<Vec3>& line, const Pose& at)
{
    physics::RigidBodyDef def{.name = "needle", .elements = {at}, .mesh = shapes::tube(line, 0.4_mm, 8, true)};
    def.collision = {{.proximity = 0.2_mm}};
    def.needle = physics::NeedleDef{.line = line, .radius = 0.4_mm};
    return def;
}

double lengthOf(const std::vector<Vec3>& line)
{
    double sum = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) sum += distance(line[i - 1], line[i]);
    return sum;
}

/// A thread of 150 nodes along a line, which begins at the needle's tail and ends at a hand, if there is one.
physics::RodBodyDef sewingThread(std::vector<Vec3> line, BodyId needle, BodyId hand)
{
    const double spacing = lengthOf(line) / (kStitchNodes - 1);
    physics::RodBodyDef def{.name = "thread", .points = std::move(line), .spacing = spacing};
    def.radius = 0.15_mm;
    def.youngModulus = 50e6;
    def.straight = def.gravity = false;
    def.friction = 0.1;
    def.rayleigh.mass = 20.0; // the air
    def.collision = physics::RodCollision{.self = false};
    def.attachments = {{.nodes = {0}, .to = needle}};
    if (hand) def.attachments.push_back({.nodes = {kStitchNodes - 1}, .to = hand});
    return def;
}

/// The needle's pose: it turns through the wound in 4 s, is lifted and drawn aside, as in examples/scenes/suture.json.
Pose stitching(double time)
{
    const auto part = [&](double from, double to) { return std::clamp((time - from) / (to - from), 0.0, 1.0); };
    const double angle = (165.0 + 332.0 * part(0.0, 4.0)) * std::numbers::pi / 180.0;
    const Vec3 lifted = part(4.0, 4.8) * Vec3{0, 12_mm, -2_mm}, aside = part(4.8, 6.6) * Vec3{-60_mm, -2_mm, -3_mm};
    return {Vec3{0, 4_mm, 0} + lifted + aside, axisAngle({0, 0, 1}, angle)};
}

} // namespace

RodScene hangingRod(int nodes)
{
    physics::RodBodyDef rod = looseRod([](double s) { return Vec3{s, 0, 0}; }, nodes);
    rod.attachments = {{.nodes = {0, 1}}};
    return {.scene = {.name = "hangs by one end", .body = "thread", .bodies = {rod}, .settle = 1.0}, .nodes = nodes};
}

RodScene rodOnFloor(int nodes)
{
    const double radius = nodes > 400 ? 40_mm : 20_mm;
    return onFloor("lies on a floor", looseRod(
                                          [radius](double s) {
                                              const double angle = s / 20_mm;
                                              return around(radius - 0.8_mm * turns(angle), angle, 0.0);
                                          },
                                          nodes));
}

RodScene coiledRod(int nodes)
{
    return onFloor("lies on a floor and itself", looseRod(
                                                     [](double s) {
                                                         const double angle = s / 10_mm;
                                                         return around(10_mm, angle, 2.4 * kRodRadius * turns(angle));
                                                     },
                                                     nodes));
}

RodScene knottedRod(int nodes)
{
    static constexpr std::array kHands{BodyId{1}, BodyId{2}}; // in the order of the bodies
    constexpr double kSpring = 100.0, kSpeed = 0.05;          // [N/m], [m/s]
    const testing::OverhandKnotDef knot{
        .turns = 8, .pitch = 3.5_mm, .loop = 3_mm, .clearance = 3.0 * kRodRadius, .tail = 10_mm};
    physics::RodBodyDef def{.name = "thread", .points = testing::overhandKnot(knot)};
    def.spacing = lengthOf(def.points) / (nodes - 1);
    def.radius = kRodRadius;
    def.youngModulus = 1e8;
    def.straight = def.gravity = false;
    def.rayleigh.mass = 5.0;
    def.collision = physics::RodCollision{};
    def.attachments = {{.nodes = {0}, .stiffness = kSpring, .to = kHands[0]},
                       {.nodes = {nodes - 1}, .stiffness = kSpring, .to = kHands[1]}};
    const std::array ends{def.points.front(), def.points.back()};
    ContactScene scene{.name = "is knotted and drawn tight", .body = "thread", .settle = 2.0};
    scene.bodies = {physics::RigidBodyDef{.name = "left hand", .elements = {{ends[0], {}}}},
                    physics::RigidBodyDef{.name = "right hand", .elements = {{ends[1], {}}}}, def};
    scene.path = [ends](double time) {
        const Vec3 drawn{0, 0, std::min(kSpeed * time, 20_mm)};
        return std::vector{std::pair{kHands[0], Pose{ends[0] - drawn}}, std::pair{kHands[1], Pose{ends[1] + drawn}}};
    };
    return {.scene = std::move(scene), .nodes = nodes};
}

RodScene stitch()
{
    static constexpr BodyId kNeedle{3}, kHand{4}; // in the order of the bodies
    const std::vector<Vec3> line = shapes::arc(9_mm, 0.0, -5.0 / 6.0 * std::numbers::pi, 16); // from tip to tail
    physics::SoftBodyDef left = skin("left edge", {20_mm, 8_mm, 24_mm}, {10, 6, 7}, {-11.5_mm, -4_mm, 0});
    left.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-19.9_mm, 1, 1}}}};
    physics::SoftBodyDef right = skin("right edge", {20_mm, 8_mm, 24_mm}, {10, 6, 7}, {11.5_mm, -4_mm, 0});
    right.attachments = {{.box = geometry::Box{{19.9_mm, -1, -1}, {1, 1, 1}}}};
    const Vec3 end{20_mm, 12_mm, 5_mm};
    const physics::RigidBodyDef hand{.name = "hand", .elements = {{end, {}}}};
    const physics::RodBodyDef thread =
        sewingThread({transform(stitching(0.0), line.back()), {12_mm, 42_mm, 12_mm}, end}, kNeedle, kHand);
    ContactScene scene{.name = "stitches a wound", .body = "thread", .settle = 0.0};
    scene.bodies = {left, right, needle(line, stitching(0.0)), hand, thread};
    scene.path = [](double time) { return std::vector{std::pair{kNeedle, stitching(time)}}; };
    return {.scene = std::move(scene), .nodes = kStitchNodes, .counted = 7.0};
}

RodScene drawnThrough(int blocks)
{
    static constexpr BodyId kNeedle{kBlocks + 1};
    constexpr double kPutAside = 20_mm; // where the other blocks are
    ContactScene scene{.name = text("is drawn through ", blocks, blocks == 1 ? " block" : " blocks"), .body = "thread"};
    for (int i = 0; i < kBlocks; ++i) {
        const Vec3 at{kApart * i, i < blocks ? 0.0 : -kPutAside, 0.0};
        physics::SoftBodyDef block = skin(text("block ", i + 1), {3_mm, 10_mm, 10_mm}, {2, 7, 6}, at);
        block.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, at.y - 4.9_mm, 1}}}};
        scene.bodies.emplace_back(std::move(block));
    }
    const auto path = [](double time) { return Pose{{-10_mm + kDrawn * time, 0.3_mm, 0.2_mm}, {}}; };
    const std::vector<Vec3> line{{}, {-5_mm, 0, 0}, {-10_mm, 0, 0}};
    const Vec3 tail = transform(path(0.0), line.back());
    scene.bodies.emplace_back(needle(line, path(0.0)));
    scene.bodies.emplace_back(sewingThread({tail, tail - Vec3{kRodEdge * (kStitchNodes - 1), 0, 0}}, kNeedle, {}));
    scene.path = [path](double time) { return std::vector{std::pair{kNeedle, path(time)}}; };
    scene.settle = (kApart * kBlocks + 20_mm) / kDrawn; // the needle has left the last block
    return {.scene = std::move(scene), .nodes = kStitchNodes, .counted = 0.4};
}

} // namespace filasofia::app
