#include "sofa/sofa_stage.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/sofa/tune.h"

#include <sofa/simulation/MutationListener.h>
#include <sofa/simulation/Node.h>

// What a saved state, a reset and the hash know besides positions; and what happens if attaching fails inside SOFA.
namespace saved_state_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

constexpr double kG = 9.81, kDt = 1e-3;

SoftBodyDef cube(const std::string& name, Vec3 corner)
{
    return {.name = name,
            .mesh = bar(2, 2, 2, {0.02, 0.02, 0.02}),
            .pose = {corner, {}},
            .material = FemMaterial{.youngModulus = 5e4, .law = Corotational{}},
            .rayleigh = {.mass = 5.0, .stiffness = 0.01}};
}

RigidBodyDef box(const std::string& name, Vec3 place, bool dynamic = false)
{
    RigidBodyDef def{.name = name, .elements = {{place, {}}}, .mesh = geometry::shapes::box({0.02, 0.02, 0.02})};
    def.dynamic = dynamic;
    return def;
}

/// A told box and a cube below it, whose upper nodes may be attached to it.
struct Hanging {
    std::unique_ptr<PhysicsServer> server;
    BodyId above, below;
    explicit Hanging(const std::string& engine, Vec3 gravity = {0, -kG, 0}) : server(serverWith(engine, kDt, gravity))
    {
        above = server->add(box("above", {0, 0.03, 0}));
        below = server->add(cube("below", {-0.01, 0, -0.01}));
        server->step(kDt);
    }
    AttachmentId attach(double pointBreakForce = kNever)
    {
        return server->attach(below, AttachmentDef{.box = geometry::Box{{-1, 0.015, -1}, {1, 0.03, 1}},
                                                   .to = above,
                                                   .pointBreakForce = pointBreakForce});
    }
    [[nodiscard]] std::vector<Vec3> nodes() const { return server->latest()->softBody(below)->positions; }
    [[nodiscard]] std::size_t attached() const { return server->latest()->attachments.size(); }
};

/// Throws where the node of a tie would come into a graph.
struct Refusing final : ::sofa::simulation::MutationListener {
    void onBeginAddChild(::sofa::simulation::Node* /*parent*/, ::sofa::simulation::Node* child) override
    {
        if (child->getName() == "tie") throw std::runtime_error("full");
    }
};

} // namespace

TEST_CASE("a saved state has its attachments, whatever was attached and released since")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    Hanging hanging(engine);
    const auto free = hanging.server->save();
    steps(*hanging.server, 50, kDt);
    const std::vector<Vec3> fallen = hanging.nodes();
    hanging.server->restore(*free);
    const AttachmentId id = hanging.attach();
    steps(*hanging.server, 300, kDt);
    const auto held = hanging.server->save();
    steps(*hanging.server, 50, kDt);
    const std::vector<Vec3> later = hanging.nodes();
    hanging.server->release(id);
    steps(*hanging.server, 50, kDt);
    REQUIRE(hanging.nodes()[0].y < later[0].y - 5e-3);

    hanging.server->restore(*held);
    REQUIRE(hanging.attached() == 1);
    CHECK(hanging.server->latest()->attachments[0].points == 9);
    steps(*hanging.server, 50, kDt);
    CHECK(hanging.nodes() == later);
    hanging.server->restore(*free);
    CHECK(hanging.attached() == 0);
    steps(*hanging.server, 50, kDt);
    CHECK(hanging.nodes() == fallen);
}

TEST_CASE("a saved state has hands, wrenches, forces, material and a grasp that waits")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef held = box("held", {0, 0.1, 0}, true);
    const BodyId hand = server->add(held), turned = server->add(box("turned", {0.1, 0.1, 0}, true));
    RigidBodyDef jaw = box("jaw", {0, 0.0301, 0});
    jaw.collision = {{}};
    SoftBodyDef soft = cube("soft", {-0.01, 0, -0.01});
    soft.collision = {{}};
    soft.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
    const BodyId tool = server->add(jaw), tissue = server->add(soft);
    server->setHaptic(hand, {.pose = {{0.01, 0.1, 0}, {}}});
    server->setWrench(turned, {0.01, 0, 0}, {0, 0, 1e-5});
    server->setForces(tissue, {{.node = 26, .force = {0.01, 0, 0}}});
    server->setMaterial(tissue, FemMaterial{.youngModulus = 2e4, .law = Corotational{}});
    server->setPose(tool, {{0, 0.0295, 0}, {}});
    steps(*server, 20, kDt);
    server->pause(true);
    server->grasp(tool, tissue);
    server->step(kDt);
    const auto saved = server->save();
    const auto run = [&] {
        server->pause(false);
        steps(*server, 20, kDt);
        const auto frame = server->latest();
        CHECK_FALSE(frame->attachments.empty());
        std::vector<Vec3> all = frame->softBody(tissue)->positions;
        for (const BodyId each : {hand, turned}) all.push_back(frame->rigidBody(each)->poses[0].position);
        return all;
    };
    const std::vector<Vec3> first = run();
    server->setHaptic(hand, {.pose = {{-1, 0, 0}, {}}});
    server->setWrench(turned, {0, 1, 0}, {});
    server->setForces(tissue, {});
    server->setMaterial(tissue, FemMaterial{.youngModulus = 9e4, .law = Corotational{}});
    steps(*server, 20, kDt);
    server->restore(*saved);
    CHECK(run() == first);
}

TEST_CASE("after a reset an attachment holds with all of its points, from where the bodies are then")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    Hanging hanging(engine);
    hanging.attach(2.0);
    steps(*hanging.server, 100, kDt);
    REQUIRE(hanging.server->latest()->attachments[0].points == 9);
    hanging.server->setForces(hanging.below, {{.node = 8, .force = {0, -2.5, 0}}}); // tears a corner off
    steps(*hanging.server, 60, kDt);
    hanging.server->setForces(hanging.below, {});
    REQUIRE(hanging.attached() == 1);
    REQUIRE(hanging.server->latest()->attachments[0].points < 9);
    hanging.server->setPose(hanging.above, {{0, 0.05, 0}, {}}); // the reset comes after it, in the same step
    hanging.server->reset();
    hanging.server->step(kDt);
    CHECK(hanging.server->latest()->rigidBody(hanging.above)->poses[0].position == Vec3{0, 0.03, 0});
    REQUIRE(hanging.attached() == 1);
    CHECK(hanging.server->latest()->attachments[0].points == 9);
    steps(*hanging.server, 500, kDt);
    CHECK(hanging.nodes()[0].y > -2e-3);
    const double fastest =
        length(std::ranges::max(hanging.server->latest()->softBody(hanging.below)->velocities, {}, lengthSquared));
    CHECK(fastest < 1e-3);
}

TEST_CASE("a weld that a reset pulls far apart draws its bodies together slowly")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    const BodyId tool = server->add(box("tool", {0, 0.13, 0})), tissue = server->add(cube("tissue", {-0.01, 0, -0.01}));
    for (int i = 1; i <= 100; ++i) {
        server->setPose(tool, {{0, 0.13 - 0.001 * i, 0}, {}});
        server->step(kDt);
    }
    server->attach(tissue, AttachmentDef{.box = geometry::Box{{-1, 0.015, -1}, {1, 0.03, 1}}, .to = tool});
    steps(*server, 10, kDt);
    server->reset(); // the tool is 10 cm away again
    double fastest = 0.0;
    for (int i = 0; i < 1500; ++i) {
        server->step(kDt);
        for (const Vec3 each : server->latest()->softBody(tissue)->velocities)
            fastest = std::max(fastest, length(each));
    }
    CHECK(fastest < 1.5);
    CHECK(server->latest()->softBody(tissue)->positions[0].y == Approx(0.1).margin(1e-3));
}

TEST_CASE("springs to nodes that are apart pull them together")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    SoftBodyDef above = cube("above", {0, 0.03, 0});
    above.attachments = {{.box = geometry::Box{{-1, 0.05 - 1e-6, -1}, {1, 1, 1}}}};
    const BodyId to = server->add(above), body = server->add(cube("below", {0, 0, 0}));
    server->attach(body, AttachmentDef{.nodes = {8}, .stiffness = 50.0, .to = to, .toNodes = {2}});
    steps(*server, 2000, kDt);
    const auto frame = server->latest();
    CHECK(length(frame->softBody(body)->positions[8] - frame->softBody(to)->positions[2]) < 1e-4);
}

TEST_CASE("the hash tells what holds bodies")
{
    const auto hashOf = [](const std::function<void(Hanging&)>& act) {
        Hanging hanging("sofa", {});
        act(hanging);
        hanging.server->pause(true);
        hanging.server->step(kDt); // nothing moves
        return hanging.server->hash();
    };
    const std::uint64_t plain = hashOf([](Hanging&) {});
    CHECK(hashOf([](Hanging&) {}) == plain);
    CHECK(hashOf([](Hanging& h) { h.attach(); }) != plain);
    CHECK(hashOf([](Hanging& h) { h.server->attach(h.below, AttachmentDef{.nodes = {0}}); }) != plain);
    CHECK(hashOf([](Hanging& h) { h.server->setHaptic(h.above, {.pose = {{1, 0, 0}, {}}}); }) != plain);
    CHECK(hashOf([](Hanging& h) { h.server->setForces(h.below, {{.node = 0, .force = {1, 0, 0}}}); }) != plain);
    CHECK(hashOf([](Hanging& h) { h.server->grasp(h.above, h.below); }) != plain);
}

TEST_CASE("an attachment or a grasp that SOFA fails to make ends as a flag, and all is as before")
{
    const bool grasps = GENERATE(false, true);
    CAPTURE(grasps);
    const auto make = [&](bool refuse) {
        const auto server = serverWith("sofa", kDt);
        RigidBodyDef jaw = box("jaw", {0, 0.0301, 0});
        jaw.collision = {{}};
        SoftBodyDef soft = cube("soft", {-0.01, 0, -0.01});
        soft.collision = {{}};
        soft.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
        const BodyId tool = server->add(jaw), tissue = server->add(soft);
        server->setPose(tool, {{0, 0.0298, 0}, {}});
        steps(*server, 20, kDt);
        Refusing refusing;
        const auto listen = [&](bool on) {
            sofaengine::tune(*server, [&refusing, on](::sofa::simulation::Node& root, const auto&) {
                if (on) root.addListener(&refusing);
                if (!on) root.removeListener(&refusing);
            });
            server->step(kDt);
        };
        if (refuse) {
            listen(true);
            if (grasps)
                server->grasp(tool, tissue);
            else
                server->attach(tissue, AttachmentDef{.nodes = {26}, .to = tool});
            const StepReport report = server->step(kDt);
            CHECK(report.has(grasps ? StepFlag::NothingAttached : StepFlag::TuneRejected));
            CHECK_FALSE(report.has(StepFlag::Undone));
            CHECK(server->latest()->attachments.empty());
            listen(false);
        } else {
            steps(*server, 3, kDt);
        }
        steps(*server, 50, kDt);
        const auto frame = server->latest();
        CHECK(frame->contacts.size() > 0);
        return frame->softBody(tissue)->positions;
    };
    CHECK(make(true) == make(false));
}

} // namespace saved_state_test
