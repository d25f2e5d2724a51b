#include "apps/laparoscopy/endoloop.h"

#include <filasofia/core/random.h>

#include "apps/laparoscopy/box.h"

#include <numbers>

using namespace filasofia;

namespace ligating {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAround = 12, kAlong = 20; // cells of the target; one through its wall
constexpr double kWall = 2.2_mm;
constexpr double kBore = 0.9_mm, kTube = 2.0_mm; // radii of the pusher
constexpr double kHidden = 14_mm;                // the thread's part in the pusher at the start
constexpr double kThread = 0.4_mm;               // its radius
constexpr double kDraws = 0.3;                   // [N], what the hand pulls with
constexpr double kDrawSpeed = 25_mm;             // [m/s], if nothing holds the thread
constexpr double kKnotBears = 10.0;              // [N]

/// The nodes on an appendage's outside, ring after ring.
std::size_t nodeAt(int ring, int i) { return static_cast<std::size_t>((ring * kAround + i % kAround) * 2 + 1); }

std::vector<Vec3> straight(double from, double to, int edges)
{
    std::vector<Vec3> out;
    for (int i = 0; i <= edges; ++i) out.push_back({0, from + (to - from) * i / edges, 0});
    return out;
}

/// The tube of the pusher from its mouth on, along z. The mouth is round: a thread that is drawn around it does not
/// ride over corners.
std::shared_ptr<const TriangleMesh> tubeMesh(double length, int around)
{
    const double half = 0.5 * (kTube - kBore);
    std::vector<Vec3> section;
    for (int i = 0; i <= 8; ++i) {
        const double turn = kPi * (i / 8.0 - 1.0);
        section.push_back({kBore + half * (1.0 + std::cos(turn)), half * (1.0 + std::sin(turn)), 0});
    }
    section.insert(section.end(), {{kTube, length, 0}, {kBore, length, 0}});
    TriangleMesh mesh = *shapes::revolved(section, around);
    for (Vec3& each : mesh.vertices) each = {each.x, -each.z, each.y};
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// [m^2], the area of a cross-section, as the length of the sum of its triangles' area vectors.
double areaOf(const std::vector<Vec3>& x, int ring)
{
    Vec3 sum;
    for (int i = 1; i + 1 < kAround; ++i)
        sum += cross(x[nodeAt(ring, i)] - x[nodeAt(ring, 0)], x[nodeAt(ring, i + 1)] - x[nodeAt(ring, 0)]);
    return 0.5 * length(sum);
}

void addAppendage(Simulation& sim, Foam& foam, std::size_t index, const char* name)
{
    const auto [around, along] = index == 1 ? std::array{kAround, kAlong} : std::array{8, 5}; // nobody ties the others
    SoftBodyDef def{.name = name,
                    .mesh = shapes::vessel(straight(0, kLength, along), kRadius - kWall, kWall, {around, 1}),
                    .pose = foam.poses[index]};
    def.material = FemMaterial{.youngModulus = 25_kPa, .poissonRatio = 0.3};
    def.mass = Density{300.0};
    def.rayleigh = {5.0, 2e-3};
    if (index != 1) def.solver = ConjugateGradient{.tolerance = 0.1};
    AttachmentDef base;
    for (int i = 0; i < around * 2; ++i) base.nodes.push_back(i);
    def.attachments = {base};
    def.collision = {{.proximity = 0.3_mm, .group = LeftTool},
                     {.primitives = {.points = false, .lines = false}, .proximity = 0.3_mm, .group = OnThread}};
    def.friction = 0.5;
    foam.appendages[index] = sim.add(def);
    sim.show(foam.appendages[index], {.subdivision = 1, .material = laparoscopy::plain(Color{0.62, 0.10, 0.08}, 0.0)});
    const double out = kRadius + 0.12_mm, in = kRadius - 0.5_mm;
    const double low = kMark - 0.5 * kMarkWidth, high = kMark + 0.5 * kMarkWidth;
    const auto band = shapes::revolved({{out, low, 0}, {out, high, 0}, {in, high, 0}, {in, low, 0}}, 48);
    sim.show(foam.appendages[index], {.surface = band, .material = laparoscopy::plain(Color{0.01, 0.01, 0.01}, 0.0)});
}

} // namespace

std::vector<Vec3> Foam::line(const FrameRef& frame) const
{
    std::vector<Vec3> out;
    const frame::SoftBodyFrame* body = frame ? frame->softBody(target()) : nullptr;
    if (body == nullptr) return out;
    for (int ring = 0; ring <= kAlong; ++ring) {
        Vec3 sum;
        for (int i = 0; i < kAround; ++i) sum += body->positions[nodeAt(ring, i)];
        out.push_back(1.0 / kAround * sum);
    }
    return out;
}

Vec3 Foam::at(const FrameRef& frame, double place) const
{
    const auto points = line(frame);
    if (points.empty()) return transform(poses[1], {0, place, 0});
    const double part = place / kLength * kAlong;
    const auto first = static_cast<std::size_t>(std::clamp(part, 0.0, kAlong - 1.0));
    return points[first] + (part - static_cast<double>(first)) * (points[first + 1] - points[first]); // beyond, too
}

Vec3 Foam::along(const FrameRef& frame, double place) const
{
    return normalized(at(frame, place + 2_mm) - at(frame, place - 2_mm));
}

double Foam::narrowing(const FrameRef& frame, double place) const
{
    const frame::SoftBodyFrame* body = frame ? frame->softBody(target()) : nullptr;
    if (body == nullptr) return 0.0;
    static const double rest =
        areaOf(shapes::vessel(straight(0, 1, 1), kRadius - kWall, kWall, {kAround, 1})->nodes, 0);
    const double middle = place / kLength * kAlong, reach = 2_mm / kLength * kAlong;
    double least = rest;
    for (int ring = 0; ring <= kAlong; ++ring)
        if (std::abs(ring - middle) <= reach) least = std::min(least, areaOf(body->positions, ring));
    return 1.0 - std::sqrt(least / rest);
}

Foam addFoam(Simulation& sim, std::uint64_t seed)
{
    Random random(seed);
    Foam foam;
    const Vec3 place{random.between(-8_mm, 8_mm), random.between(-3_mm, 3_mm), random.between(-6_mm, 6_mm)};
    const Quat lean = axisAngle({1, 0, 0}, -28_deg + random.between(-6_deg, 6_deg)) *
                      axisAngle({0, 0, 1}, random.between(-6_deg, 10_deg));
    const Pose stand{place, axisAngle({0, 1, 0}, random.between(-15_deg, 15_deg)) * lean};
    constexpr std::array kNames = {"left appendage", "middle appendage", "right appendage"};
    for (std::size_t i = 0; i < 3; ++i) {
        const double side = static_cast<double>(i) - 1.0;
        foam.poses[i] = stand * Pose{{side * 20_mm, 0, -std::abs(side) * 4_mm}, axisAngle({0, 0, 1}, -side * 18_deg)};
        addAppendage(sim, foam, i, kNames[i]);
    }
    RigidBodyDef block{.name = "foam", .elements = {stand * Pose{{0, -7.5_mm, -2_mm}, {}}}};
    block.mesh = shapes::box({70_mm, 16_mm, 26_mm});
    sim.show(sim.add(block), {.material = laparoscopy::plain(Color{0.62, 0.10, 0.08}, 0.0)});
    RigidBodyDef table{
        .name = "table", .elements = {{{0, -35_mm, 0}, {}}}, .mesh = shapes::box({600_mm, 10_mm, 500_mm})};
    sim.show(sim.add(table), {.material = laparoscopy::plain(Color{0.05, 0.16, 0.20}, 0.0)});
    return foam;
}

LaparoscopicInstrumentDef pusherOf(const Training& training)
{
    LaparoscopicInstrumentDef def = laparoscopy::instrumentOf(laparoscopy::RightSide, training);
    def.name = "pusher";
    def.start.insertion -= 40_mm;
    def.tool = {.kind = InstrumentKind::LaparoscopicScissors,
                .shaft = tubeMesh(350_mm, 32),
                .shaftCollision = tubeMesh(10_mm, 24),
                .jaws = {{.opensBy = 0.01}}, // drawn as nothing: it is what the hand closes
                .groups = {OnThread},
                .opening = 1.0,
                .proximity = 0.2_mm,
                .friction = 0.1,
                .grasps = false,
                .material = laparoscopy::plain(Color{0.80, 0.82, 0.86}, 0.3)};
    return def;
}

Endoloop::Endoloop(Simulation& sim, const LaparoscopicInstrument& pusher) : sim_(sim), pusher_(pusher)
{
    const Pose mouth = pivotOf(pusher.def().trocar, pusher.def().start);
    RigidBodyDef knot{.name = "knot", .elements = {mouth * Pose{{-1.3_mm, 0, -1_mm}, {}}}, .dynamic = true};
    knot.mesh = shapes::ellipsoid({1.8_mm, 0.9_mm, 1.2_mm}, 4);
    knot.linearDamping = knot.angularDamping = 20.0;
    knot.attachments = {{.to = pusher.body()}};
    knot_ = sim.add(knot);

    RigidBodyDef hand{.name = "hand at the thread", .elements = {mouth * Pose{{0, 0, kHidden}, {}}}};
    JointDef draw{.kind = JointKind::Prismatic, .axis = {0, 0, 1}, .lower = 0.0, .upper = 80_mm};
    draw.command = JointPosition{};
    draw.damping = kDraws / kDrawSpeed;
    draw.inertia = 0.02 * draw.damping;
    draw.mass = GivenInertia{.mass = 1e-3, .moments = {1e-8, 1e-8, 1e-8}};
    hand.articulation = {.joints = {draw}, .to = pusher.body(), .offset = {{0, 0, kHidden}, {}}};
    hand_ = sim.add(hand);

    RodBodyDef def{.name = "thread", .spacing = 1.5_mm, .pose = mouth, .radius = kThread, .youngModulus = 80e6};
    def.points = {{-2.6_mm, 0, 1_mm}, {-2.6_mm, 0, -1.5_mm}};
    constexpr double kLoop = 12.5_mm; // its radius at the start
    for (int i = 0; i < 60; ++i) {
        const double angle = kPi * (0.62 + 1.76 * i / 59.0);
        def.points.push_back({kLoop * std::cos(angle), 0, -6_mm - kLoop + kLoop * std::sin(angle)});
    }
    def.points.insert(def.points.end(), {{0, 0, -1_mm}, {0, 0, kHidden}});
    def.rayleigh = {20.0, 2e-3};
    def.collision = RodCollision{.group = OnThread, .self = false};
    def.friction = 0.1;
    const int last = static_cast<int>(physics::centreLine(def).size()) - 1;
    def.attachments = {{.nodes = {0, 1}, .to = knot_}, {.nodes = {last - 1, last}, .to = hand_, .element = 1}};
    thread_ = sim.add(def);

    const TissueMaterial violet = laparoscopy::plain(Color{0.20, 0.06, 0.45}, 0.2);
    sim.show(knot_, {.material = violet});
    sim.show(thread_, {.material = violet});
    sim.everyStep([this](double) { step(); });
}

void Endoloop::step()
{
    const FrameRef now = sim_.physics().latest();
    if (!now || free_) return;
    if (asked_) return fix(*now);
    const bool draws = pusher_.tool().opening() < 0.5;
    if (std::exchange(drawing_, draws) == draws) return;
    sim_.physics().setJoint(hand_, 0,
                            draws ? JointCommand(JointForce{kDraws}) : JointCommand(JointPosition{drawn(*now)}));
}

void Endoloop::fix(const frame::Frame& now)
{
    auto& server = sim_.physics();
    const std::size_t count = ahead(now);
    const int last = static_cast<int>(count) - 1;
    server.attach(thread_, {.nodes = {last - 1, last}, .to = knot_, .breakForce = kKnotBears});
    server.release(server.attachments(thread_)[1]);
    server.release(server.attachments(knot_)[0]);
    fixed_ = count;
    free_ = true;
}

std::size_t Endoloop::ahead(const frame::Frame& now) const
{
    if (free_) return fixed_;
    const auto& x = now.softBody(thread_)->positions;
    const Pose back = inverse(now.rigidBody(pusher_.body())->poses[0]);
    std::size_t count = x.size();
    while (count > 3 && transform(back, x[count - 1]).z > 0.0) --count;
    return count;
}

std::vector<Vec3> Endoloop::loop(const FrameRef& frame) const
{
    if (!frame || frame->softBody(thread_) == nullptr) return {};
    const auto& x = frame->softBody(thread_)->positions;
    return {x.begin() + 1, x.begin() + static_cast<std::ptrdiff_t>(ahead(*frame))};
}

Vec3 Endoloop::knot(const FrameRef& frame) const { return frame->rigidBody(knot_)->poses[0].position; }

double Endoloop::drawn(const frame::Frame& now) const { return now.rigidBody(hand_)->joints[0].position; }

std::optional<double> placeAround(const std::vector<Vec3>& loop, const std::vector<Vec3>& line)
{
    if (loop.size() < 3) return {};
    Vec3 middle;
    for (const Vec3& each : loop) middle += 1.0 / static_cast<double>(loop.size()) * each;
    // The line goes through the triangles between the loop and its middle.
    int turns = 0;
    double before = 0.0, place = 0.0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Vec3 from = line[i], step = line[i + 1] - from;
        for (std::size_t k = 0; k < loop.size(); ++k) {
            const Vec3 a = loop[k] - middle, b = loop[(k + 1) % loop.size()] - middle, normal = cross(a, b);
            const double down = dot(step, normal);
            if (down == 0.0) continue;
            const double part = dot(middle - from, normal) / down;
            if (part < 0.0 || part >= 1.0) continue;
            const Vec3 at = from + part * step - middle;
            const double area = dot(normal, normal);
            const double u = dot(cross(at, b), normal) / area, v = dot(cross(a, at), normal) / area;
            if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
            turns += down > 0.0 ? 1 : -1;
            place = before + part * length(step);
        }
        before += length(step);
    }
    if (turns != 1 && turns != -1) return {};
    return place;
}

} // namespace ligating
