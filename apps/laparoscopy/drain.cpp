#include "apps/laparoscopy/drain.h"

#include <filasofia/core/random.h>

using namespace filasofia;

namespace suturing {
namespace {

constexpr Vec3 kWall = {14e-3, 8e-3, 20e-3};          // [m], each side
constexpr std::array<int, 3> kCells = {7, 4, 10};     // so that a node lies at each mark
constexpr double kGape = 2e-3, kGapeAtEnds = 1.0e-3;  // [m], the slit
constexpr double kTop = 22e-3, kTable = -8e-3;        // [m], heights
constexpr double kNeedle = 0.4e-3, kThread = 0.15e-3; // [m], radii

TissueMaterial plain(Color color)
{
    return {.baseColor = color,
            .subsurfaceColor = color,
            .wetness = 0.0,
            .thickness = 0.0,
            .mottling = 0.0,
            .vessels = 0.0};
}

/// One side of the drain, in the drain's coordinates: the slit is an eye.
std::shared_ptr<const TetMesh> wallMesh(double side)
{
    TetMesh mesh = *shapes::block(kWall, kCells);
    for (Vec3& node : mesh.nodes) {
        const double along = 2.0 * node.z / kWall.z, inner = 0.5 - side * node.x / kWall.x; // [-], 1 at the slit
        const double gape = kGape - (kGape - kGapeAtEnds) * along * along;
        node += Vec3{side * 0.5 * kWall.x, -0.5 * kWall.y, 0.0};
        node.x += side * 0.5 * (kGape + inner * (gape - kGape));
    }
    return std::make_shared<const TetMesh>(std::move(mesh));
}
int nearest(const TetMesh& mesh, Vec3 place)
{
    const auto found = std::ranges::min_element(mesh.nodes, {}, [&](Vec3 each) { return distance(each, place); });
    return static_cast<int>(found - mesh.nodes.begin());
}

void addWall(Simulation& sim, Drain& drain, Wall wall)
{
    const double side = wall == LeftWall ? -1.0 : 1.0;
    const auto mesh = wallMesh(side);
    SoftBodyDef def{.name = wall == LeftWall ? "left wall" : "right wall", .mesh = mesh, .pose = drain.pose};
    def.material = FemMaterial{.youngModulus = 50_kPa, .poissonRatio = 0.45};
    AttachmentDef glue;
    for (std::size_t i = 0; i < mesh->nodes.size(); ++i) {
        if (mesh->nodes[i].y < -kWall.y + 1e-6) glue.nodes.push_back(static_cast<int>(i));
        if (side * mesh->nodes[i].x > kWall.x) drain.outer[wall].push_back(static_cast<int>(i));
    }
    def.attachments = {glue};
    def.collision = {{.proximity = 0.3_mm}};
    def.puncture = PunctureDef{.force = 0.25, .cutting = 0.08, .friction = 6.0};
    drain.marks[wall] = nearest(*mesh, {side * kMark, 0, 0});
    drain.lips[wall] = nearest(*mesh, {side * 0.5 * kGape, 0, 0});
    drain.walls[wall] = sim.add(def);
    TissueMaterial latex{.baseColor = {0.78, 0.55, 0.28}, .wetness = 0.15, .mottling = 0.0, .vessels = 0.0};
    sim.show(drain.walls[wall], {.subdivision = 1, .material = latex});
}

/// A curve through points (Catmull and Rom 1974).
std::vector<Vec3> smooth(const std::vector<Vec3>& points)
{
    constexpr int kParts = 12;
    std::vector<Vec3> out;
    const auto last = points.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
        const Vec3 a = points[i], b = points[i + 1];
        const Vec3 before = 0.5 * (b - points[i > 0 ? i - 1 : 0]), after = 0.5 * (points[std::min(i + 2, last)] - a);
        for (int k = 0; k < kParts; ++k) {
            const double t = static_cast<double>(k) / kParts, u = t * t * (3.0 - 2.0 * t);
            out.push_back(a + u * (b - a) + t * (1.0 - t) * ((1.0 - t) * before - t * after));
        }
    }
    out.push_back(points.back());
    return out;
}

/// A needle that stands in its cushion, across the shaft that will hold it, and its thread, which lies behind it.
void addNeedle(Simulation& sim, Drain& drain, const TrocarDef& towards)
{
    const Vec3 middle = transform(drain.pose, {34_mm, 0, 4_mm});
    const Quat across = pivotOf(towards, poseAt(towards, middle)).orientation;
    const auto line = shapes::arc(kRadius, 0.0, kArc, 20);
    RigidBodyDef needle{.name = "needle", .dynamic = true, .gravity = false};
    needle.elements = {{middle, across * axisAngle({0, 0, 1}, -25_deg)}};
    needle.mesh = shapes::tube(line, kNeedle, 8, true);
    needle.mass = Density{7800};
    needle.linearDamping = needle.angularDamping = 5.0;
    needle.collision = {{.proximity = 0.2_mm}};
    needle.needle = NeedleDef{.line = line, .radius = kNeedle};
    needle.attachments = {{.stiffness = 200.0, .breakForce = 0.3}};
    drain.needle = sim.add(needle);
    sim.show(drain.needle, {.material = MetalMaterial{}});

    const double cushion = 0.5 * (middle.y - 0.8 * kRadius + kTable);
    RigidBodyDef stand{.name = "cushion", .elements = {{{middle.x, cushion, middle.z}, drain.pose.orientation}}};
    stand.mesh = shapes::box({9_mm, 2.0 * (cushion - kTable), 9_mm});
    sim.show(sim.add(stand), {.material = plain({0.10, 0.12, 0.35})});

    const Vec3 tail = transform(needle.elements[0], line.back());
    const auto beside = [&](Vec3 by) { return middle + rotate(drain.pose.orientation, by); };
    const auto onTable = [&](Vec3 by) {
        const Vec3 at = beside(by);
        return Vec3{at.x, kTable + by.y, at.z};
    };
    RodBodyDef thread{.name = "thread", .spacing = kThreadSpacing, .radius = kThread, .youngModulus = 50_MPa};
    thread.points =
        smooth({tail, beside({-10_mm, 2_mm, -7_mm}), beside({-4_mm, -4_mm, -16_mm}), onTable({6_mm, 8_mm, -24_mm}),
                onTable({26_mm, 3_mm, -30_mm}), onTable({42_mm, 2_mm, -20_mm}), onTable({42_mm, 2_mm, 4_mm})});
    thread.straight = thread.gravity = false;
    thread.yieldStrain = 0.1;    // it keeps sharp bends
    thread.rayleigh.mass = 20.0; // the air
    thread.collision = RodCollision{};
    thread.attachments = {{.nodes = {0}, .to = drain.needle}};
    drain.thread = sim.add(thread);
    sim.show(drain.thread, {.material = ThreadMaterial{.baseColor = {0.10, 0.10, 0.50}, .pitch = 0.75_mm}});
}

} // namespace

Vec3 Drain::mark(const frame::Frame& now, Wall wall) const
{
    return now.softBody(walls[wall])->positions[static_cast<std::size_t>(marks[wall])];
}
double Drain::gap(const frame::Frame& now) const
{
    const auto lip = [&](Wall wall) {
        return now.softBody(walls[wall])->positions[static_cast<std::size_t>(lips[wall])];
    };
    return distance(lip(LeftWall), lip(RightWall));
}
Vec3 Drain::onNeedle(const frame::Frame& now, double angle) const
{
    return transform(now.rigidBody(needle)->poses[0], kRadius * Vec3{std::cos(angle), std::sin(angle), 0.0});
}
Vec3 Drain::inward(const frame::Frame& now, double angle) const
{
    return rotate(now.rigidBody(needle)->poses[0].orientation, {-std::cos(angle), -std::sin(angle), 0.0});
}

Drain addDrain(Simulation& sim, const TrocarDef& towards, std::uint64_t seed)
{
    Random random(seed);
    Drain drain;
    const Vec3 place{random.between(-4_mm, 4_mm), kTop, random.between(-4_mm, 4_mm)}, away = towards.fulcrum - place;
    drain.pose = {place, axisAngle({0, 1, 0}, std::atan2(away.x, away.z) + random.between(-4_deg, 4_deg))};
    for (const Wall wall : {LeftWall, RightWall}) addWall(sim, drain, wall);

    const double under = kTop - kWall.y - 0.6_mm; // glued walls need no contacts
    RigidBodyDef foam{.name = "foam",
                      .elements = {{{place.x, 0.5 * (under + kTable), place.z}, drain.pose.orientation}}};
    foam.mesh = shapes::box({42_mm, under - kTable, 28_mm});
    foam.collision = {{.proximity = 0.2_mm}};
    sim.show(sim.add(foam), {.material = plain({0.16, 0.20, 0.24})});
    RigidBodyDef table{
        .name = "table", .elements = {{{0, kTable - 5_mm, 0}, {}}}, .mesh = shapes::box({600_mm, 10_mm, 500_mm})};
    table.collision = {{.proximity = 0.2_mm}};
    sim.show(sim.add(table), {.material = plain({0.05, 0.16, 0.20})});

    RigidBodyDef dots{.name = "marks"};
    dots.elements = {drain.pose * Pose{{-kMark, 0, 0}}, drain.pose * Pose{{kMark, 0, 0}}};
    dots.mesh = shapes::ellipsoid({0.8_mm, 0.15_mm, 0.8_mm}, 6);
    drain.dots = sim.add(dots);
    sim.show(drain.dots, {.material = plain({0.01, 0.01, 0.01})});
    addNeedle(sim, drain, towards);
    sim.everyStep([&sim, drain](double) {
        const FrameRef now = sim.physics().latest();
        if (!now) return;
        for (const Wall wall : {LeftWall, RightWall})
            sim.physics().setPose(drain.dots, {drain.mark(*now, wall), drain.pose.orientation}, wall);
    });
    return drain;
}

void releaseThread(Simulation& sim, const Drain& drain)
{
    for (const AttachmentId each : sim.physics().attachments(drain.thread)) sim.physics().release(each);
}

void load(Simulation& sim, const Drain& drain, double force)
{
    for (const Wall wall : {LeftWall, RightWall}) {
        const Vec3 each = force / static_cast<double>(drain.outer[wall].size()) *
                          rotate(drain.pose.orientation, {wall == LeftWall ? -1.0 : 1.0, 0, 0});
        std::vector<NodalForce> forces;
        for (const int node : drain.outer[wall]) forces.push_back({node, each});
        sim.physics().setForces(drain.walls[wall], forces);
    }
}

Stitch stitchOf(const Drain& drain, const frame::Frame& now)
{
    Stitch stitch;
    std::array<bool, 2> threaded = {};
    const auto& thread = now.softBody(drain.thread)->positions;
    for (const frame::Channel& channel : now.channels) {
        const Wall wall = channel.tissue == drain.walls[LeftWall] ? LeftWall : RightWall;
        if (wall == LeftWall && !channel.through) continue;
        const Vec3 at = wall == RightWall ? channel.entry : channel.end;
        const double away = distance(at, drain.mark(now, wall));
        if (stitch.deviation[wall] && *stitch.deviation[wall] <= away) continue;
        stitch.deviation[wall] = away;
        threaded[wall] = channel.inside == drain.thread;
        if (wall == LeftWall || !threaded[wall]) continue;
        const auto near = std::ranges::min_element(thread, {}, [&](Vec3 each) { return distance(each, at); });
        stitch.tail = kThreadSpacing * static_cast<double>(thread.end() - near - 1);
    }
    stitch.threaded = threaded[LeftWall] && threaded[RightWall];
    return stitch;
}

} // namespace suturing
