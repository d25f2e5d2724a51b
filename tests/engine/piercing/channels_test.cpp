#include "filasofia/core/log.h"
#include "filasofia/engine/piercing/threading.h"

#include "engine/needles.h"

/// What needles and threads do besides going in and out along one line.
namespace channels_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kSlow = 0.03 * kNeedleStep; // [m] per step

/// The largest force [N] of a channel on its tissue.
double largestForce(const frame::Frame& frame)
{
    double largest = 0.0;
    for (const frame::Channel& each : frame.channels) largest = std::max(largest, length(each.force));
    return largest;
}

} // namespace

TEST_CASE("a thread that was released in tissue leaves the needle free, wherever that goes")
{
    Stitch stitch;
    stitch.pull(0.005); // the thread is through
    REQUIRE(stitch.in.frame.channels.size() == 1);
    REQUIRE(stitch.in.frame.channels[0].inside == stitch.thread);
    SECTION("the needle is laid aside")
    {
        const Scene& scene = stitch.in.stage.world.scene();
        stitch.in.stage.post(physics::Release{scene.attachments.back().id});
        double largest = 0.0;
        for (int i = 1; i <= 100; ++i) { // 50 mm to the side, below the block
            CHECK(stitch.in.put(stitch.in.height - kSlow, 0.4e-3 + 0.5e-3 * i).flags == 0);
            largest = std::max(largest, largestForce(stitch.in.frame));
        }
        REQUIRE(stitch.in.frame.channels.size() == 1);
        CHECK(stitch.in.frame.channels[0].inside == stitch.thread);
        CHECK(largest < 0.3); // 10 N/m along 4 mm: the friction of the thread, and what turns it
    }
    SECTION("the needle is removed")
    {
        stitch.in.stage.post(physics::RemoveBody{stitch.in.tool});
        for (int i = 0; i < 200; ++i) CHECK(stitch.in.stage.step(kNeedleStep).flags == 0);
        stitch.in.stage.world.capture(stitch.in.frame);
        REQUIRE(stitch.in.frame.channels.size() == 1);
        CHECK(stitch.in.frame.channels[0].inside == stitch.thread);
        CHECK(stitch.in.frame.channels[0].length == Approx(Stitch::kThick).epsilon(0.1));
        CHECK(largestForce(stitch.in.frame) < 0.3);
    }
}

TEST_CASE("a thread that is torn off while its needle is in the tissue lets the needle go on alone")
{
    Stitch stitch;
    stitch.pull(-0.5 * Stitch::kThick); // the tail, and the thread's front, are in the middle of the block
    REQUIRE(stitch.in.frame.channels.size() == 1);
    stitch.in.stage.post(physics::Release{stitch.in.stage.world.scene().attachments.back().id});
    stitch.in.move(-kSlow);
    REQUIRE(stitch.in.frame.channels.size() == 2); // the needle's part and the thread's
    CHECK(stitch.in.frame.channels[0].needle == stitch.in.tool);
    CHECK(stitch.in.frame.channels[1].inside == stitch.thread);
    const double both = stitch.in.frame.channels[0].length + stitch.in.frame.channels[1].length;
    CHECK(both == Approx(Stitch::kThick).margin(1.1e-3)); // a point stands for a millimetre
    stitch.pull(0.01);
    REQUIRE(stitch.in.frame.channels.size() == 1);
    CHECK(stitch.in.frame.channels[0].inside == stitch.thread);
    CHECK(largestForce(stitch.in.frame) < 0.1);
}

TEST_CASE("a thread that is cut beside its needle leaves a stump of one node, which follows into no channel")
{
    // The stump was taken for a line and read beyond its only node: each run had other bits.
    for (const bool inTissue : {true, false}) {
        INFO((inTissue ? "in the tissue" : "above it"));
        Stitch stitch;
        stitch.pull(inTissue ? -0.5 * Stitch::kThick : -1.5 * Stitch::kThick);
        REQUIRE(stitch.in.frame.channels.size() == 1);
        stitch.in.stage.world.scene().soft[1].topology.cutEdges = {{0, 0.5}};
        for (int i = 0; i < 5; ++i) stitch.in.move(-kSlow);
        const Scene& scene = stitch.in.stage.world.scene();
        REQUIRE(scene.channels.size() == (inTissue ? 2 : 1));
        REQUIRE(scene.channels[0].lines.size() == 1);
        CHECK(scene.channels[0].lines[0].body == stitch.in.tool);
        stitch.pull(0.01);
        REQUIRE(stitch.in.frame.channels.size() == (inTissue ? 1 : 0));
        CHECK(largestForce(stitch.in.frame) < 0.1);
    }
}

TEST_CASE("a membrane thinner than a needle is pierced, passed, and lets go of the tip")
{
    constexpr double kThin = 0.6e-3;
    Insertion in(1e-3, {.force = 0.05, .cutting = 0.05, .friction = 10.0});
    auto def = tissueBlock(kThin, {.force = 0.02, .cutting = 0.02, .friction = 10.0});
    def.mesh = geometry::shapes::block({0.03, kThin, 0.03}, {20, 1, 20});
    def.pose.position.y = -0.02 - 0.5 * kThin; // below the block
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.0149, 1, 1}}},
                       {.box = geometry::Box{{0.0149, -1, -1}, {1, 1, 1}}}};
    const BodyId membrane = in.stage.add(def);
    const auto channelIn = [&](BodyId tissue) {
        const auto found = std::ranges::find(in.frame.channels, tissue, &frame::Channel::tissue);
        return found == in.frame.channels.end() ? frame::Channel{} : *found;
    };
    while (in.height > -0.03) in.put(in.height - kSlow);
    CHECK(channelIn(membrane).through);
    CHECK(channelIn(membrane).tip == 0.0);
    CHECK(channelIn(membrane).length <= 2.0 * kThin);
    CHECK(length(channelIn(membrane).force) < 0.1);
}

TEST_CASE("a needle that is drawn back and goes in beside its path cuts a new one, and is not drawn to the old one")
{
    Insertion in(0.02, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    while (in.height > -0.012) in.move(-kSlow);
    while (in.height < -0.003) in.move(kSlow);
    const std::size_t before = in.stage.world.scene().channels.at(0).points.size();
    // In again, turned by 25 degrees about the place where the tip is.
    const Quat turn = axisAngle({0, 0, 1}, 0.44);
    const Vec3 way = rotate(turn, {0, -1, 0}), from{0.4e-3, in.height, 0.3e-3};
    for (int i = 1; i <= 20; ++i) in.put(in.height, from.x, axisAngle({0, 0, 1}, 0.022 * i));
    double deep = 0.0, tip = 0.0;
    for (; deep < 0.008; deep += kSlow) {
        in.put(from.y + deep * way.y, from.x + deep * way.x, turn);
        if (deep > 0.006) tip = std::max(tip, in.frame.channels.at(0).tip);
    }
    REQUIRE(in.frame.channels.size() == 1);
    CHECK(tip == Approx(0.1).epsilon(0.05)); // it cuts
    const Channel& channel = in.stage.world.scene().channels[0];
    CHECK(channel.points.size() < before + 4);
    const Vec3 end = in.frame.channels[0].end;
    CHECK(length(end - (from + deep * way)) < 1.5e-3); // along the new way
}

TEST_CASE("a needle that jumps far in a step leaves its points on the way, and has not come out")
{
    Insertion in(0.02, {.force = 0.05, .cutting = 0.0, .friction = 0.0});
    while (in.frame.channels.empty() && in.height > -0.01) in.move(-kSlow);
    while (in.height > -0.003) in.move(-kSlow);
    in.put(-0.013); // through five layers of elements
    for (int i = 0; i < 50; ++i) in.put(-0.013);
    REQUIRE(in.frame.channels.size() == 1);
    CHECK_FALSE(in.frame.channels[0].through);
    const Channel& channel = in.stage.world.scene().channels[0];
    CHECK(channel.points.size() >= 7);
    double whole = 0.0;
    for (const ChannelPoint& each : channel.points) {
        CHECK(each.before <= 2.0 * channel.spacing);
        whole += each.before;
    }
    CHECK(whole == Approx(0.013).margin(1.5e-3));
}

namespace {

/// A block with a slit across the needle's way, from below the upper side on: two lips that are this far apart [m].
Insertion slit(double apart)
{
    // Two layers in one mesh, not connected.
    geometry::TetMesh mesh = *geometry::shapes::block({0.03, 0.006, 0.03}, {8, 3, 8});
    const auto nodes = static_cast<int>(mesh.nodes.size());
    const std::vector<Vec3> upper = mesh.nodes;
    const auto elements = mesh.tetrahedra;
    for (Vec3 each : upper) mesh.nodes.push_back(each - Vec3{0, 0.006 + apart, 0});
    for (geometry::Tetrahedron each : elements) {
        for (int& node : each) node += nodes;
        mesh.tetrahedra.push_back(each);
    }
    Insertion in(0.02, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    in.stage.post(physics::RemoveBody{in.block});
    auto def = tissueBlock(0.006, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    def.mesh = std::make_shared<const geometry::TetMesh>(std::move(mesh));
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.0149, 1, 1}}},
                       {.box = geometry::Box{{0.0149, -1, -1}, {1, 1, 1}}}};
    in.block = in.stage.add(def);
    return in;
}

} // namespace

TEST_CASE("a needle goes from one lip of a wound into the other, whether they touch or gape")
{
    for (const double apart : {1e-6, 0.8e-3, 3e-3}) {
        INFO("lips " << apart << " m apart");
        Insertion in = slit(apart);
        double tip = 0.0;
        while (in.height > -0.010 - apart) {
            in.put(in.height - kSlow);
            if (in.height < -0.009 - apart) // in the middle of the lower lip
                for (const frame::Channel& each : in.frame.channels) tip = std::max(tip, each.tip);
        }
        double inside = 0.0;
        for (const frame::Channel& each : in.frame.channels) inside += each.length;
        CHECK(tip == Approx(0.1).epsilon(0.05));  // it cuts, so its thread will follow
        if (apart < 1e-3) CHECK(inside > 0.0065); // more than the upper lip, which the needle draws down
    }
}

TEST_CASE("the hub of a needle is felt when it comes to the skin")
{
    Insertion in(0.02, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    in.stage.post(physics::RemoveBody{in.tool});
    auto def = straightNeedle(in.height);
    def.needle->line = {{0, -kToTip, 0}, {0, 0, 0}}; // up to the hub
    geometry::TriangleMesh hub = *geometry::shapes::box({0.01, 0.004, 0.01}, {4, 1, 4});
    for (Vec3& each : hub.vertices) each.y += 0.002; // its face is where the line ends
    def.collision = {{.proximity = 0.3e-3},
                     {.mesh = std::make_shared<const geometry::TriangleMesh>(hub), .proximity = 0.3e-3}};
    in.tool = in.stage.add(def);
    double before = 0.0, pressed = 0.0;
    while (in.height > -kToTip - 1e-3) { // the hub, 1 mm deep
        in.put(in.height - kSlow);
        double force = 0.0;
        for (const frame::Contact& each : in.frame.contacts) force += each.normalForce;
        (in.height > -kToTip + 2e-3 ? before : pressed) = force;
    }
    CHECK(before < 0.05);
    CHECK(pressed > 0.3);
}

TEST_CASE("a channel that was cut across and gapes rubs only along what is tissue")
{
    Insertion in = slit(1e-6);
    while (in.height > -0.010) in.put(in.height - kSlow);
    double closed = 0.0, open = 0.0;
    for (const frame::Channel& each : in.frame.channels) closed += each.length;
    // The lower lip moves away by 8 mm, and the needle with it.
    Scene& scene = in.stage.world.scene();
    std::vector<Vec3>& x = scene.soft[0].state.x;
    for (std::size_t i = x.size() / 2; i < x.size(); ++i) x[i].y -= 8e-3;
    scene.rigid[0].state.poses[0].position.y -= 8e-3;
    for (const Channel& each : scene.channels) open += Threading(scene, each).length();
    CHECK(open <= closed + 2e-3);
}

TEST_CASE("tissue holds a needle ten times as stiffly as it is, also after its material has changed")
{
    Insertion in(0.02);
    in.put(in.height);
    CHECK(in.stage.model().puncture->stiffness == Approx(10.0 * 3e4));
    in.stage.post(physics::SetMaterial{in.block, physics::FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.45}});
    in.put(in.height);
    CHECK(in.stage.model().puncture->stiffness == Approx(10.0 * 5e3));
}

TEST_CASE("tissue that is pinned where a needle goes in resists it and is pierced like any other")
{
    constexpr double kThick = 6e-3;
    Insertion in(kThick);
    in.stage.post(physics::RemoveBody{in.block});
    physics::SoftBodyDef held = tissueBlock(kThick);
    held.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}}};
    in.block = in.stage.add(held);
    double strongest = 0.0;
    while (in.height > -1e-3) {
        const double push = in.move(-kSlow);
        if (in.frame.channels.empty()) strongest = std::max(strongest, push);
    }
    CHECK(strongest >= kSkin.force);
    CHECK(strongest < 1.2 * kSkin.force); // it grows by 0.1 N per step
    REQUIRE(in.frame.channels.size() == 1);
    CHECK(length(in.frame.channels[0].entry - Vec3{0.4e-3, 0.0, 0.3e-3}) < kNeedleRadius);
    double push = 0.0;
    while (in.height > -4e-3) push = in.move(-kSlow);
    const frame::Channel& channel = in.frame.channels.at(0);
    CHECK(channel.length == Approx(4e-3).epsilon(0.1));
    CHECK(push == Approx(kSkin.cutting + kSkin.friction * channel.length).epsilon(0.02));
    while (in.height < 1e-3) push = std::min(push, in.move(kSlow));
    CHECK(push < -0.9 * kSkin.friction * 3e-3); // it holds the needle as that is drawn back
    CHECK(in.frame.channels.empty());
}

TEST_CASE("a rod that is a needle pierces by the same law, and its elasticity does the rest")
{
    Insertion in(0.02, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    in.stage.post(physics::RemoveBody{in.tool});
    physics::RodBodyDef def{.name = "needle", .points = {{0.4e-3, 1e-3, 0.3e-3}, {0.4e-3, 0.031, 0.3e-3}}};
    def.spacing = 1e-3;
    def.radius = kNeedleRadius;
    def.youngModulus = 200e9;
    def.gravity = false;
    def.friction = 0.0;
    def.needle = true;
    def.collision = physics::RodCollision{.self = false};
    const BodyId hand =
        in.stage.add(physics::RigidBodyDef{.name = "hand", .elements = {Pose{{0.4e-3, 0.03, 0.3e-3}, {}}}});
    def.attachments = {{.nodes = {29, 30}, .to = hand}};
    in.stage.add(def);
    double y = 0.03, force = 0.0;
    const auto move = [&](double dy) {
        y += dy;
        in.stage.post(physics::SetPose{hand, 0, Pose{{0.4e-3, y, 0.3e-3}, {}}});
        CHECK(in.stage.step(kNeedleStep).flags == 0);
        in.stage.world.capture(in.frame);
    };
    while (y > 0.03 - 0.011) {
        move(-kSlow);
        if (!in.frame.channels.empty()) force = -in.frame.channels[0].force.y;
    }
    REQUIRE(in.frame.channels.size() == 1);
    const double inside = in.frame.channels[0].length;
    CHECK(inside == Approx(0.010).margin(1.5e-3));
    CHECK(force == Approx(0.1 + 10.0 * inside).epsilon(0.03));
    while (y < 0.03 + 2e-3) move(kSlow);
    CHECK(in.frame.channels.empty());
}

TEST_CASE("a tip that slips through soft tissue counts as having pierced it, and that is told")
{
    // A layer of 15 kPa gives by its whole thickness before the contacts at the tip reach 0.5 N.
    Stage stage;
    physics::SoftBodyDef def{.name = "layer", .mesh = geometry::shapes::block({0.024, 0.006, 0.024}, {12, 3, 12})};
    def.material = physics::FemMaterial{.youngModulus = 15e3, .poissonRatio = 0.4};
    def.gravity = false;
    def.collision = {{}};
    def.puncture = physics::PunctureDef{};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.0119, 1, 1}}},
                       {.box = geometry::Box{{0.0119, -1, -1}, {1, 1, 1}}}};
    stage.add(def);
    const std::vector<Vec3> line = {{0, 0, 0}, {0, 15e-3, 0}, {0, 30e-3, 0}};
    physics::RigidBodyDef tool{.name = "needle",
                               .elements = {Pose{{0.5e-3, 10e-3, 0.5e-3}, {}}},
                               .mesh = geometry::shapes::tube(line, 0.4e-3, 8, true)};
    tool.collision = {{}};
    tool.needle = physics::NeedleDef{.line = line, .radius = 0.4e-3};
    const BodyId needle = stage.add(tool);
    std::string told;
    setLogSink([&](LogLevel, std::string_view words) { told += text(words, "\n"); });
    frame::Frame frame;
    const auto move = [&](double from, double to) {
        for (int i = 1; i <= 600; ++i) {
            stage.post(physics::SetPose{needle, 0, Pose{{0.5e-3, from + i / 600.0 * (to - from), 0.5e-3}, {}}});
            stage.step(1e-3);
        }
        stage.world.capture(frame);
    };
    move(10e-3, -14e-3);
    REQUIRE(frame.channels.size() == 1);
    CHECK(frame.channels[0].through);
    CHECK(frame.channels[0].length == Approx(6e-3).epsilon(0.2));
    CHECK(told == "the tip of rigid body 'needle' slipped through the surface of soft body 'layer' with less than the "
                  "0.5 N that pierce it: it counts as pierced\n");
    move(-14e-3, 10e-3);
    CHECK(frame.channels.empty());
    setLogSink({});
}

TEST_CASE("a frame names no channel of a body that is gone")
{
    Insertion in(0.02);
    while (in.height > -0.008) in.move(-kSlow);
    in.stage.post(physics::RemoveBody{in.block});
    in.stage.step(0.0); // paused
    in.stage.world.capture(in.frame);
    CHECK(in.frame.channels.empty());
}

} // namespace channels_test
