#include "filasofia/engine/piercing/threading.h"

#include "engine/needles.h"
#include "verification/attached.h"

/// Needles in tissue: forces over depth, threads that follow, and what they hold together.
namespace filasofia::engine {
namespace needle_test {
TEST_CASE("the force on a needle rises to the puncture, falls, grows with its length, and turns round")
{
    Insertion in(0.02);
    const double speed = 0.02;
    double atPuncture = 0.0;
    while (in.frame.channels.empty() && in.height > -0.015)
        atPuncture = std::max(atPuncture, in.move(-speed * kNeedleStep));
    REQUIRE(in.frame.channels.size() == 1);
    verifyWithin("needle: force at the puncture, relative to the threshold", atPuncture / kSkin.force, 0.9, 1.1);

    for (int i = 0; i < 100; ++i) in.move(-speed * kNeedleStep); // what the puncture released has settled
    double worst = 0.0, shallow = 0.0, deep = 0.0;
    for (int i = 0; i < 500; ++i) {
        const double force = in.move(-speed * kNeedleStep), length = in.frame.channels.at(0).length;
        const double exact = kSkin.cutting + kSkin.friction * length;
        worst = std::max(worst, std::abs(force / exact - 1.0));
        if (i == 0) shallow = length;
        deep = length;
    }
    tell("needle: depth at first [m]", shallow);
    tell("needle: depth at last [m]", deep);
    verify("needle: going in, error of the force, relative to cutting + friction * length", worst, 0.03);

    for (int i = 0; i < 150; ++i) in.move(speed * kNeedleStep); // the friction turns round
    worst = 0.0;
    for (int i = 0; i < 200; ++i) {
        const double force = in.move(speed * kNeedleStep), exact = -kSkin.friction * in.frame.channels.at(0).length;
        worst = std::max(worst, std::abs(force / exact - 1.0));
        CHECK(in.frame.channels.at(0).tip == 0.0);
    }
    verify("needle: coming out, error of the force, relative to friction * length", worst, 0.03);
    while (!in.frame.channels.empty() && in.height < 0.01) in.move(speed * kNeedleStep);
    CHECK(in.stage.world.scene().channels.empty());
}

TEST_CASE(
    "force over depth of an insertion and a retraction is that of a rigid-plastic law, but where friction turns round")
{
    // Okamura, Simone and O'Leary 2004: cutting at the tip and friction per length; here without elastic parts.
    Insertion in(0.02);
    const double speed = 0.02;
    while (in.frame.channels.empty() && in.height > -0.015) in.move(-speed * kNeedleStep);
    for (int i = 0; i < 100; ++i) in.move(-speed * kNeedleStep);
    std::vector<std::array<double, 2>> samples; // measured, by the law
    for (int i = 0; i < 500; ++i) {
        const double force = in.move(-speed * kNeedleStep);
        samples.push_back({force, kSkin.cutting + kSkin.friction * in.frame.channels.at(0).length});
    }
    for (int i = 0; i < 500; ++i) {
        const double force = in.move(speed * kNeedleStep);
        samples.push_back({force, -kSkin.friction * in.frame.channels.at(0).length});
    }
    const auto rSquared = [](std::span<const std::array<double, 2>> all) {
        double mean = 0.0, missed = 0.0, spread = 0.0;
        for (const auto& [measured, exact] : all) mean += measured / static_cast<double>(all.size());
        for (const auto& [measured, exact] : all) {
            missed += (measured - exact) * (measured - exact);
            spread += (measured - mean) * (measured - mean);
        }
        return 1.0 - missed / spread;
    };
    verifyWithin("needle: insertion and retraction, R2 of the rigid-plastic law", rSquared(samples), 0.85, 1.0);
    samples.erase(samples.begin() + 500, samples.begin() + 650); // tissue goes with the needle
    verifyWithin("needle: the same without the 3 mm in which friction turns round", rSquared(samples), 0.999, 1.0);
}

TEST_CASE("a hand that moves a needle to and fro in tissue at random never gets back more work than it has done")
{
    for (const unsigned seed : {1u, 2u, 3u}) {
        Insertion in(0.02);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> depth(-0.014, 1e-3), speed(5e-3, 0.1);
        double work = 0.0, least = 0.0, moved = 0.0;
        for (int stroke = 0; stroke < 25; ++stroke) {
            const double target = depth(random), step = speed(random) * kNeedleStep;
            for (int i = 0; i < 80 && std::abs(target - in.height) > step; ++i) {
                const double way = std::copysign(step, target - in.height), given = -in.move(way) * way;
                work += given;
                moved += std::abs(given);
                least = std::min(least, work);
            }
        }
        verify(text("needle: seed ", seed,
                    ": most work that a hand got back beyond what it had done, of all that it moved"),
               -least / moved, 1e-6);
        verifyWithin(text("needle: seed ", seed, ": work that tissue kept, of all that the hand moved"), work / moved,
                     0.0, 1.0);
    }
}

TEST_CASE("a needle comes out on the other side, and its thread follows through the channel with its own friction")
{
    Stitch stitch;
    const auto& channels = stitch.in.frame.channels;
    stitch.pull(-Stitch::kThick); // the tail is at the upper side
    REQUIRE(channels.size() == 1);
    CHECK(channels[0].through);
    CHECK(channels[0].inside == stitch.in.tool);
    verifyWithin("needle: length of shaft in a block, relative to its thickness", channels[0].length / Stitch::kThick,
                 0.9, 1.1);
    stitch.pull(0.01);
    REQUIRE(channels.size() == 1);
    CHECK(channels[0].inside == stitch.thread);
    double worst = 0.0;
    for (int i = 0; i < 200; ++i) {
        stitch.in.move(-0.03 * kNeedleStep);
        worst = std::max(worst, std::abs(-channels.at(0).force.y / (10.0 * channels[0].length) - 1.0));
    }
    verify("needle: thread that is drawn through a block, error of the force, relative to friction * length", worst,
           0.03);
    // The thread's end passes, and nothing is left of the channel.
    stitch.pull(0.07);
    CHECK(channels.empty());
    CHECK(stitch.in.stage.world.scene().channels.empty());
}

TEST_CASE("a thread that is cut in tissue lies in two channels: the part at the needle goes on, the other one stays")
{
    Stitch stitch;
    stitch.pull(0.01);
    stitch.cutAt(-0.5 * Stitch::kThick);
    const std::vector<Channel>& channels = stitch.in.stage.world.scene().channels;
    REQUIRE(channels.size() == 2);
    const auto& frames = stitch.in.frame.channels;
    stitch.in.move(-0.03 * kNeedleStep);
    REQUIRE(frames.size() == 2);
    // All of the thread but the edge that is gone.
    CHECK(frames[0].length + frames[1].length > Stitch::kThick - 1.5e-3);
    CHECK(frames[0].length + frames[1].length < Stitch::kThick);
    const auto& x = stitch.in.stage.soft(1).x;
    const Vec3 end = x.back();
    for (int i = 0; i < 10; ++i) stitch.in.move(-0.03 * kNeedleStep); // what the cut released has settled
    double worst = 0.0;
    for (int i = 0; i < 20; ++i) {
        const double before = frames.at(0).length; // that in which the step computed the force
        stitch.in.move(-0.03 * kNeedleStep);
        worst = std::max(worst, std::abs(-frames.at(0).force.y / (10.0 * before) - 1.0));
    }
    verify("needle: thread that was cut in a block and is drawn out, error of the force, relative to friction * length",
           worst, 0.03);
    stitch.pull(0.03);
    CHECK(channels.size() == 1);
    CHECK(channels[0].through);
    CHECK(distance(x.back(), end) < 2e-4);
    for (Vec3 each : x) CHECK(isFinite(each));
}

TEST_CASE("a thread that is cut below or above the tissue leaves it with one channel, and each part has its own end")
{
    Stitch below;
    below.pull(0.01);
    below.cutAt(-Stitch::kThick - 5e-3);
    const Vec3 end = below.in.stage.soft(1).x.back();
    below.pull(0.03);
    CHECK(below.in.stage.world.scene().channels.size() == 1);
    CHECK(below.in.stage.world.scene().channels[0].lines.size() == 1);
    CHECK(distance(below.in.stage.soft(1).x.back(), end) < 2e-4); // nothing draws it any more

    Stitch above;
    above.pull(0.01);
    above.cutAt(5e-3);
    const std::size_t last = 20;
    const Vec3 free = above.in.stage.soft(1).x.back();
    CHECK(above.in.stage.world.scene().channels.size() == 1);
    above.pull(0.03); // the part at the needle comes out of the tissue altogether
    CHECK(above.in.stage.world.scene().channels.empty());
    CHECK(distance(above.in.stage.soft(1).x.back(), free) < 2e-4);
    CHECK(above.in.stage.soft(1).x[last - 10].y < -Stitch::kThick);
}

TEST_CASE("a channel bears what pushes the thread sideways, with Coulomb's friction on top")
{
    // A straight needle is held sideways by springs, so a lateral force F raises its friction by mu F.
    const double mu = 0.5, side = 0.3;
    Insertion in(0.02, {.force = 0.3, .cutting = 0.0, .friction = 10.0});
    in.move(0.0); // the bodies are there
    for (SoftBody& each : in.stage.world.scene().soft) each.model.friction = mu;
    for (RigidBody& each : in.stage.world.scene().rigid) each.model.friction = mu;
    while (in.height > -0.012) in.move(-0.03 * kNeedleStep);
    for (int i = 0; i < 300; ++i) in.move(0.01 * kNeedleStep);
    const double straight = -in.move(0.01 * kNeedleStep) - 10.0 * in.frame.channels.at(0).length;
    verify("needle: friction without a lateral force, beyond friction * length [N]", std::abs(straight), 0.01);
    // Pushed sideways by so much that the tissue answers with about `side`.
    double force = 0.0, x = 0.4e-3;
    for (int i = 0; i < 400 && force < side; ++i) {
        x += 1e-5;
        in.height += 0.01 * kNeedleStep;
        in.stage.post(physics::SetPose{in.tool, 0, Pose{{x, in.height + kToTip, 0.3e-3}, {}}});
        in.stage.step(kNeedleStep);
        in.stage.world.capture(in.frame);
        force = std::hypot(in.frame.channels.at(0).force.x, in.frame.channels.at(0).force.z);
    }
    REQUIRE(force >= side);
    // Points may push to both sides, so the sum of what they press with is at least the magnitude of their sum.
    const frame::Channel& channel = in.frame.channels.at(0);
    verifyWithin("needle: friction under a lateral force, relative to friction * length + mu F",
                 std::abs(channel.friction) / (10.0 * channel.length + mu * force), 0.97, 1.5);
}

namespace {

/// The hashes of a stitch, and of the same after a reset or from a state that was saved while the needle is inside.
std::vector<std::uint64_t> hashesOf(Stitch& stitch, int steps)
{
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < steps; ++i) {
        stitch.in.move(-0.03 * kNeedleStep);
        hashes.push_back(stitch.in.stage.world.hash());
    }
    return hashes;
}

} // namespace

TEST_CASE("stitching gives the same bits for any number of threads, and from a state that was saved in the tissue")
{
    constexpr int kSteps = 1500; // the thread has followed
    Stitch one(1), three(3);
    const auto first = hashesOf(one, kSteps);
    CHECK(first == hashesOf(three, kSteps));
    REQUIRE(one.in.frame.channels.size() == 1);
    CHECK(one.in.frame.channels[0].inside == one.thread);

    Stitch again(1);
    hashesOf(again, 600);
    REQUIRE(again.in.frame.channels.size() == 1);
    CHECK(again.in.frame.channels[0].inside == again.in.tool);
    const auto saved = again.in.stage.world.save();
    const double height = again.in.height;
    const auto after = hashesOf(again, kSteps - 600);
    CHECK(std::ranges::equal(after, std::span(first).subspan(600)));
    again.in.stage.world.restore(*saved);
    again.in.height = height;
    CHECK(hashesOf(again, kSteps - 600) == after);
}

TEST_CASE("a channel goes with its tissue, its needle and a reset")
{
    Stitch stitch(1);
    hashesOf(stitch, 600);
    Stage& stage = stitch.in.stage;
    REQUIRE(stage.world.scene().channels.size() == 1);
    SECTION("the tissue is removed")
    {
        stage.post(physics::RemoveBody{stitch.in.block});
        stage.step(kNeedleStep);
        CHECK(stage.world.scene().channels.empty());
    }
    SECTION("the needle is removed")
    {
        stage.post(physics::RemoveBody{stitch.in.tool});
        stage.run(2, kNeedleStep);
        CHECK(stage.world.scene().channels.empty()); // the thread had not come so far
    }
    SECTION("the scene is reset")
    {
        stage.post(physics::Reset{});
        stage.step(kNeedleStep);
        CHECK(stage.world.scene().channels.empty());
    }
}

TEST_CASE("tissue with a needle in it may be cut beside it and through it")
{
    physics::SoftBodyDef def = tissueBlock(0.01, kSkin);
    def.dynamicTopology = true;
    Stage stage;
    stage.add(def);
    const BodyId tool = stage.add(straightNeedle(1e-3));
    double height = 1e-3;
    const auto move = [&](double dy) {
        height += dy;
        stage.post(physics::SetPose{tool, 0, Pose{{0.4e-3, height + kToTip, 0.3e-3}, {}}});
        return stage.step(kNeedleStep);
    };
    while (height > -0.007) move(-0.03 * kNeedleStep);
    REQUIRE(stage.world.scene().channels.size() == 1);
    const std::size_t points = stage.world.scene().channels[0].points.size();
    // A knife goes across, 2 mm below the upper side, through the needle's place.
    physics::RigidBodyDef knife{.name = "knife", .elements = {Pose{{-0.02, -2e-3, 0}, {}}}};
    knife.collision = {{.mesh = geometry::shapes::sheet(2e-3, 0.04, {1, 10}), .proximity = 0, .cutting = true}};
    const BodyId blade = stage.add(knife);
    double opened = 0.0;
    for (double x = -0.02; x < 0.02; x += 0.1 * kNeedleStep) {
        stage.post(physics::SetPose{blade, 0, Pose{{x, -2e-3, 0}, {}}});
        for (const physics::Rupture& each : stage.step(kNeedleStep).topology.ruptures) opened += each.area;
    }
    CHECK(opened > 0.5e-4);
    REQUIRE(stage.world.scene().channels.size() == 1);
    const Channel& channel = stage.world.scene().channels[0];
    CHECK(channel.points.size() == points);
    for (const ChannelPoint& point : channel.points) { // each still where the needle is
        const Vec3 at = meanOf(point.nodes, stage.soft().x);
        CHECK(std::hypot(at.x - 0.4e-3, at.z - 0.3e-3) < 1.5e-3);
    }
    // Finite, and it comes out. Where the knife has left slivers, some steps end before friction has settled, and the
    // upper part sinks into the lower: tissue does not collide with itself here.
    const auto allowed =
        static_cast<unsigned>(physics::StepFlag::NotConverged) | static_cast<unsigned>(physics::StepFlag::Intersecting);
    for (int i = 0; i < 500; ++i) CHECK((move(0.03 * kNeedleStep).flags & ~allowed) == 0);
    CHECK(isFinite(stage.soft().x[0]));
}

} // namespace needle_test
} // namespace filasofia::engine
