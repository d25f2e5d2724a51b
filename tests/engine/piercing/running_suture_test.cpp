#include "engine/needles.h"

#include <numbers>

/// One needle with one thread that passes through the same tissue again and again, from alternating sides.
namespace running_suture_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kDt = 1e-3, kLong = 12e-3, kRadius = 0.3e-3, kEdge = 2e-3;
constexpr double kSpeed = 0.12, kTurning = 9.0; // [m/s], [rad/s] of the needle
constexpr double kBeside = 5e-3;                // [m] from pass to pass

/// One block, or two with a wound between them, around x = 0; passes run along x, side by side along z.
struct Sewing {
    Stage stage;
    frame::Frame frame;
    std::vector<BodyId> blocks;
    BodyId needle, thread;
    int passes;
    double far;                      ///< [m] where the needle's tail comes out to on each side
    Vec3 place;                      ///< [m] where the needle's tail is
    double angle = 0.0;              ///< about y
    double fastest = 0.0;            ///< [m/s] that of the thread's fastest node
    double longest = 0.0;            ///< [-] stretch of the thread, in the mean of its edges
    bool undone = false;             ///< a channel that was through is so no more
    int inverted = 0;                ///< steps in which elements were inside out
    std::vector<std::uint64_t> seen; ///< hashes of the steps

    Sewing(int count, double gap, double young = 20e3, int threads = 1) : stage({.threads = threads}), passes(count)
    {
        const double wide = gap > 0.0 ? 10e-3 : 8e-3, along = kBeside * passes + 4e-3;
        far = (gap > 0.0 ? 0.5 * gap + wide : 0.5 * wide) + kLong + 6e-3;
        place = {-far, 0, -0.5 * kBeside * (passes - 1)};
        for (const double side : {-1.0, 1.0}) {
            physics::SoftBodyDef def{.name = "tissue",
                                     .mesh = geometry::shapes::block({wide, 6e-3, along}, {4, 3, 12})};
            def.pose.position.x = gap > 0.0 ? 0.5 * side * (gap + wide) : 0.0;
            def.material = physics::FemMaterial{.youngModulus = young, .poissonRatio = 0.45};
            def.gravity = false;
            def.collision = {{}};
            def.friction = 0.0;
            def.puncture = physics::PunctureDef{.force = 0.1, .cutting = 0.03, .friction = 1.0, .stiffness = 2e5};
            geometry::Box held{{-1, -1, -1}, {1, -2.9e-3, 1}}; // its lower side
            if (gap > 0.0) {                                   // the side that is far from the wound
                const double x = side * (0.5 * gap + wide);
                held = {{x - 1e-4, -1, -1}, {x + 1e-4, 1, 1}};
            }
            def.attachments = {{.box = held}};
            blocks.push_back(stage.add(def));
            if (gap == 0.0) break;
        }
        physics::RigidBodyDef def{.name = "needle",
                                  .elements = {Pose{place, {}}},
                                  .mesh = geometry::shapes::tube({{0, 0, 0}, {kLong, 0, 0}}, kRadius, 8, true)};
        def.collision = {{}};
        def.needle = physics::NeedleDef{.line = {{kLong, 0, 0}, {0, 0, 0}}, .radius = kRadius};
        needle = stage.add(def);
        const double hanging = 2.0 * far * passes + 0.04;
        physics::RodBodyDef rod{.name = "thread", .points = {place, place - Vec3{hanging, 0, 0}}};
        rod.spacing = kEdge;
        rod.radius = 0.12e-3;
        rod.youngModulus = 0.3e9;
        rod.gravity = false;
        rod.friction = 0.1;
        rod.collision = physics::RodCollision{};
        rod.attachments = {{.nodes = {0}, .to = needle}};
        thread = stage.add(rod);
        step();
    }
    const SoftBody& rod() { return stage.world.scene().soft.back(); }
    /// [-] That of the first edges together.
    double stretch(std::size_t edges)
    {
        double now = 0.0, rest = 0.0;
        for (std::size_t i = 0; i < edges; ++i) {
            now += length(rod().state.x[i + 1] - rod().state.x[i]);
            rest += rod().model.rod.edges[i].restLength;
        }
        return now / rest - 1.0;
    }
    void step()
    {
        const auto flags = static_cast<std::uint32_t>(stage.step(kDt).flags);
        constexpr auto kInverted = static_cast<std::uint32_t>(physics::StepFlag::Inverted);
        CHECK((flags & ~kInverted) == 0);
        inverted += flags != 0 ? 1 : 0;
        std::vector<bool> before;
        for (const frame::Channel& each : frame.channels) before.push_back(each.through);
        stage.world.capture(frame);
        for (std::size_t i = 0; i < std::min(before.size(), frame.channels.size()); ++i)
            undone = undone || (before[i] && !frame.channels[i].through);
        for (Vec3 v : rod().state.v) fastest = std::max(fastest, length(v));
        longest = std::max(longest, stretch(rod().model.rod.edges.size()));
        seen.push_back(stage.world.hash());
    }
    /// Moves the needle's tail there, and turns the needle.
    void go(Vec3 to, double turned)
    {
        const Vec3 from = place;
        const double before = angle;
        const double time = std::max(length(to - from) / kSpeed, std::abs(turned - before) / kTurning);
        const int steps = std::max(1, static_cast<int>(time / kDt));
        for (int i = 1; i <= steps; ++i) {
            const double part = static_cast<double>(i) / steps;
            place = from + part * (to - from);
            angle = before + part * (turned - before);
            stage.post(physics::SetPose{needle, 0, Pose{place, axisAngle({0, 1, 0}, angle)}});
            step();
        }
    }
    void pass(int k)
    {
        const double side = k % 2 == 0 ? 1.0 : -1.0, z = kBeside * (k - 0.5 * (passes - 1));
        go({-side * far, 0, z}, kPi * k);
        go({side * far, 0, z}, kPi * k);
    }
    void sew()
    {
        for (int k = 0; k < passes; ++k) pass(k);
    }
    /// [m] How far the faces of the wound are apart in the mean of the edges that are sewn.
    double width()
    {
        std::array<double, 2> face{}, count{};
        for (std::size_t b = 0; b < 2; ++b) {
            const SoftBody& block = stage.world.scene().soft[b];
            for (std::size_t i = 0; i < block.state.x.size(); ++i)
                if (std::abs(block.model.rest[i].x) == Approx(0.5 * kGap)) face[b] += block.state.x[i].x, ++count[b];
        }
        return face[1] / count[1] - face[0] / count[0];
    }
    static constexpr double kGap = 3e-3, kPi = std::numbers::pi;
};

void checkSewing(int passes, double gap)
{
    INFO(passes << " passes, a wound of " << gap << " m");
    Sewing sewing(passes, gap);
    sewing.sew();
    CHECK(sewing.frame.channels.size() == sewing.blocks.size() * static_cast<std::size_t>(passes));
    for (const frame::Channel& each : sewing.frame.channels) {
        CHECK(each.through);
        CHECK(each.inside == sewing.thread);
    }
    CHECK_FALSE(sewing.undone);
    CHECK(sewing.inverted == 0);
    CHECK(sewing.fastest < 1.0);
    CHECK(sewing.longest < 0.01);
}

} // namespace

TEST_CASE("a needle that passes through a body again and again leaves its thread where it was drawn before")
{
    checkSewing(4, 0.0);
    checkSewing(4, Sewing::kGap);
}

TEST_CASE("six passes of a needle are as good as four", "[long]")
{
    checkSewing(6, 0.0);
    checkSewing(6, Sewing::kGap);
}

TEST_CASE("a running suture draws a wound together")
{
    Sewing sewing(4, Sewing::kGap, 5e3);
    sewing.sew();
    const double open = sewing.width();
    CHECK(open > 0.9 * Sewing::kGap);
    // The thread is held before it first goes in, and drawn at the needle, which has come out on the same side.
    const std::vector<Vec3>& x = sewing.rod().state.x;
    const auto isBefore = [](Vec3 p) { return p.x < -0.5 * Sewing::kGap - 12e-3 && p.z < -1.5 * kBeside + 1e-3; };
    const auto held = static_cast<int>(std::ranges::find_if(x, isBefore) - x.begin());
    sewing.stage.post(physics::Attach{{++sewing.stage.lastAttachment}, sewing.thread, {.nodes = {held}}});
    sewing.go(sewing.place - Vec3{0.03, 0, 0}, sewing.angle);
    CHECK_FALSE(sewing.undone);
    CHECK(sewing.inverted <= 2); // tissue of 5 kPa under a taut thread of a quarter of a millimetre
    CHECK(sewing.fastest < 2.0);
    CHECK(sewing.width() < 0.6 * open);
}

TEST_CASE("sewing gives the same bits for any number of threads, and from a state that was saved between two passes")
{
    constexpr int kPasses = 3;
    Sewing one(kPasses, 0.0), three(kPasses, 0.0, 20e3, 3);
    three.sew();
    CHECK(three.inverted == 0);
    one.pass(0);
    one.pass(1);
    const auto saved = one.stage.world.save();
    const Vec3 place = one.place;
    const double angle = one.angle;
    const std::size_t before = one.seen.size();
    one.pass(2);
    CHECK(one.seen == three.seen);
    one.stage.world.restore(*saved);
    one.place = place;
    one.angle = angle;
    one.seen.resize(before);
    one.pass(2);
    CHECK(one.seen == three.seen);
}

} // namespace running_suture_test
