#include "engine/shapes.h"
#include "engine/stage.h"
#include "filasofia/core/log.h"

using namespace filasofia;
using namespace filasofia::engine;
using physics::AttachmentDef;
using physics::RigidAttachmentDef;

namespace {

/// A cube of 2 cm in eight cells, its low corner at (x, 0, 0).
physics::SoftBodyDef cube(double x = 0.0)
{
    physics::SoftBodyDef def{.name = "cube", .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}))};
    def.pose.position.x = x;
    return def;
}

physics::RigidBodyDef rigidBox(Vec3 at, Vec3 half = {0.01, 0.01, 0.01}, bool dynamic = false)
{
    physics::RigidBodyDef def{.name = "box", .elements = {Pose{at, {}}}, .mesh = shared(boxSurface(half))};
    def.dynamic = dynamic;
    return def;
}

/// A stage without gravity, with a soft cube (1) and what else is given (2), and what was logged.
struct Scene {
    Stage stage;
    std::vector<std::string> warnings;

    explicit Scene(const physics::SoftBodyDef& first = cube())
    {
        setLogSink([this](LogLevel level, std::string_view line) {
            if (level == LogLevel::Warning) warnings.emplace_back(line);
        });
        stage.add(first);
    }
    Scene(const Scene&) = delete;
    ~Scene() { setLogSink({}); }

    AttachmentId attach(const AttachmentDef& def)
    {
        stage.post(physics::Attach{{++stage.lastAttachment}, {1}, def});
        return {stage.lastAttachment};
    }
    AttachmentId attachRigid(BodyId body, const RigidAttachmentDef& def)
    {
        stage.post(physics::AttachRigid{{++stage.lastAttachment}, body, def});
        return {stage.lastAttachment};
    }
    Model& model() { return stage.world.model(); }
    State& state() { return stage.world.state(); }
    /// The nodes that the only attachment holds.
    std::vector<int> nodes()
    {
        REQUIRE(state().attachments.size() == 1);
        std::vector<int> found;
        for (const auto& pair : state().attachments[0].pairs) found.push_back(pair[0].nodes.at(0).node);
        return found;
    }
    const frame::Attachment* held(AttachmentId id)
    {
        const auto found = std::ranges::find(state().held, id, &frame::Attachment::id);
        return found == state().held.end() ? nullptr : &*found;
    }
};

std::vector<int> nodesOfCube(const std::function<bool(Vec3)>& where)
{
    return nodesWhere(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}), where);
}

} // namespace

TEST_CASE("an attachment holds the nodes that are named, in the box or in the ball, each once")
{
    Scene scene;
    scene.attach({.nodes = {3, 0, 3},
                  .box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}},
                  .ball = physics::Ball{{0.02, 0.02, 0.02}, 0.0101}});
    scene.stage.step(1e-3);
    CHECK(scene.nodes() == nodesOfCube([](Vec3 p) { return p.x < 1e-6 || distance(p, {0.02, 0.02, 0.02}) < 0.0101; }));
}

TEST_CASE("regions are those of the moment, not of the start")
{
    Scene scene;
    scene.stage.step(1e-3);
    for (Vec3& p : scene.stage.soft().x) p.x += 1.0;
    scene.attach({.box = geometry::Box{{0.99, -1, -1}, {1.001, 1, 1}}});
    scene.stage.step(1e-3);
    CHECK(scene.nodes() == nodesOfCube([](Vec3 p) { return p.x < 1e-6; }));
}

TEST_CASE("within a distance of another body, soft or rigid, or inside it")
{
    const auto addOther = [](Scene& scene, bool soft, double x) { // that begins at x
        if (soft)
            scene.stage.add(cube(x));
        else
            scene.stage.add(rigidBox({x + 0.01, 0.01, 0.01}));
    };
    for (const bool soft : {true, false})
        for (const double within : {1.1e-3, 0.9e-3}) {
            Scene scene;
            addOther(scene, soft, 0.021);
            scene.attach({.within = within, .to = {2}});
            const bool nothing = scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached);
            CHECK(nothing == (within < 1e-3));
            if (!nothing) {
                CHECK(scene.nodes() == nodesOfCube([](Vec3 p) { return p.x > 0.0199; }));
                continue;
            }
            CHECK(scene.state().attachments.empty());
            REQUIRE(scene.warnings.size() == 1);
            CHECK_THAT(scene.warnings[0], Catch::StartsWith("soft body 'cube': attachment.within"));
        }
    for (const bool soft : {true, false}) { // the cube's middle and right are inside the other, or on its surface
        Scene scene;
        addOther(scene, soft, 0.0095);
        scene.attach({.to = {2}});
        scene.stage.step(1e-3);
        CHECK(scene.nodes() == nodesOfCube([](Vec3 p) { return p.x > 0.0099; }));
    }
}

TEST_CASE("a region without a node is told, and nothing is held")
{
    Scene scene;
    const AttachmentId id = scene.attach({.box = geometry::Box{{1, 1, 1}, {2, 2, 2}}});
    CHECK(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
    CHECK(scene.state().attachments.empty());
    REQUIRE(scene.warnings.size() == 1);
    CHECK_THAT(scene.warnings[0], Catch::StartsWith("soft body 'cube': attachment.box: no node is there"));
    scene.stage.post(physics::Release{id});
    CHECK_FALSE(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
}

TEST_CASE("nodes held by the nearest node of another body are drawn to it; those held where they are stay apart")
{
    for (const physics::AttachMode mode : {physics::AttachMode::Nearest, physics::AttachMode::Barycentric}) {
        Scene scene;
        scene.stage.add(cube(0.0204)); // corners 0.4 mm apart
        scene.attach({.within = 1e-3, .to = {2}, .mode = mode});
        scene.stage.run(300, 1e-3);
        REQUIRE(scene.nodes().size() == 9);
        const auto right = nodesOfCube([](Vec3 p) { return p.x > 0.0199; });
        const auto left = nodesOfCube([](Vec3 p) { return p.x < 1e-6; });
        for (std::size_t i = 0; i < right.size(); ++i) {
            const double apart = distance(scene.stage.soft(0).x[static_cast<std::size_t>(right[i])],
                                          scene.stage.soft(1).x[static_cast<std::size_t>(left[i])]);
            if (mode == physics::AttachMode::Nearest)
                CHECK(apart < 1e-6);
            else
                CHECK(apart == Approx(0.4e-3).epsilon(0.02));
        }
    }
}

TEST_CASE("an element without points is held as a whole, and follows what holds it")
{
    Scene scene;
    scene.stage.add(rigidBox({0.2, 0, 0}));
    scene.stage.add(rigidBox({0.2, 0.05, 0}, {0.01, 0.02, 0.03}, true));
    scene.attachRigid({3}, {.to = {2}});
    scene.stage.post(physics::SetGravity{{0, -9.81, 0}});
    scene.stage.step(1e-3);
    const Vec3 axis = normalized(Vec3{1, 2, 3});
    for (int i = 1; i <= 500; ++i) {
        scene.stage.post(physics::SetPose{{2}, 0, {{0.2 + 2e-4 * i, 0, 0}, turnAbout(axis, 2e-3 * i)}});
        scene.stage.step(1e-3);
    }
    scene.stage.run(300, 1e-3);
    const Pose tool = scene.state().rigidBodies[0].poses[0], box = scene.state().rigidBodies[1].poses[0];
    CHECK(distance(box.position, transform(tool, {0, 0.05, 0})) < 1e-6);
    CHECK(std::abs(dot(box.orientation, tool.orientation)) > 1.0 - 1e-9);
}

TEST_CASE("a rigid body is held by soft tissue where its points are")
{
    Scene scene;
    scene.stage.add(rigidBox({0.01, 0.01, 0.01}, {0.004, 0.004, 0.004}, true));
    const AttachmentId id = scene.attachRigid({2}, {.to = {1}});
    scene.stage.run(200, 1e-3); // nothing pulls
    REQUIRE(scene.held(id) != nullptr);
    CHECK(scene.held(id)->points == 4);
    CHECK(distance(scene.state().rigidBodies[0].poses[0].position, {0.01, 0.01, 0.01}) < 1e-9);
    scene.stage.post(physics::SetWrench{{2}, 0, {0.01, 0, 0}, {}});
    scene.stage.step(1e-3);
    CHECK(scene.held(id)->force.x < 0.0);
}

TEST_CASE("what is released is free in the next step, whether it was held by pins or since")
{
    for (const bool pins : {true, false})
        for (const double stiffness : {physics::kHard, 50.0}) {
            physics::SoftBodyDef def = cube();
            AttachmentDef hold{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .stiffness = stiffness};
            if (pins) def.attachments = {hold};
            Scene scene(def);
            scene.stage.post(physics::SetGravity{{0, -10, 0}});
            const AttachmentId id = pins ? AttachmentId{1} : scene.attach(hold);
            scene.stage.run(100, 1e-3);
            REQUIRE(scene.held(id) != nullptr);
            CHECK(scene.held(id)->force.y > 0.02);
            const auto momentum = [&] {
                double sum = 0.0;
                for (std::size_t i = 0; i < scene.stage.soft().v.size(); ++i)
                    sum += scene.stage.model().masses[i] * scene.stage.soft().v[i].y;
                return sum;
            };
            const double before = momentum();
            scene.stage.post(physics::Release{id});
            scene.stage.step(1e-3);
            CHECK(scene.held(id) == nullptr);
            CHECK(momentum() - before == Approx(-10.0 * 0.008 * 1e-3).epsilon(0.02)); // its weight, and nothing else
            scene.stage.post(physics::Release{id});
            scene.stage.step(1e-3); // once more is no harm
        }
}

TEST_CASE("of two groups of pins that hold a node one lets go, and the other holds on")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.nodes = {0, 1, 2, 3, 4, 5}}, {.nodes = {3, 4, 5, 6, 7, 8}}}; // the left face
    Scene scene(def);
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.run(500, 1e-3);
    const double weight = 0.08;
    CHECK(length(scene.held({1})->force + scene.held({2})->force - Vec3{0, weight, 0}) < 0.02 * weight);
    scene.stage.post(physics::Release{{1}});
    scene.stage.step(1e-3);
    CHECK(scene.stage.model().pins.hard[3]);
    CHECK_FALSE(scene.stage.model().pins.hard[0]);
    scene.stage.post(physics::SetMaterial{{1}, physics::FemMaterial{}, nullptr});
    scene.stage.run(100, 1e-3);
    CHECK(scene.stage.soft().x[3] == scene.stage.model().rest[3]);
    CHECK(scene.stage.soft().x[0] != scene.stage.model().rest[0]);
}

TEST_CASE("a material set after pins were released does not bring them back")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.nodes = {0, 1}}};
    Scene scene(def);
    scene.stage.post(physics::Release{{1}});
    scene.stage.post(physics::SetMaterial{{1}, physics::FemMaterial{}, scene.stage.world.build(def)});
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.run(100, 1e-3);
    CHECK(scene.stage.soft().x[0].y == Approx(-0.05).epsilon(0.02));
}

TEST_CASE("an attachment breaks where it has to bear more than it stands, and says so once")
{
    Scene scene(cube());
    const AttachmentId id = scene.attach({.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .breakForce = 0.05});
    for (int i = 0; i < 1000 && !scene.held(id); ++i) scene.stage.step(1e-3);
    int told = 0;
    for (int i = 0; i < 800; ++i) { // up to 0.1 N
        std::vector<physics::NodalForce> forces;
        for (int node = 0; node < 27; ++node) forces.push_back({node, {i * 0.1 / 27 / 800, 0, 0}});
        scene.stage.post(physics::SetForces{{1}, forces});
        if (scene.held(id) && scene.held(id)->broken) scene.stage.step(0.0); // while paused it is told no more
        if (scene.held(id) && scene.held(id)->broken) FAIL("told twice");
        scene.stage.step(1e-3);
        if (const auto* now = scene.held(id); now && now->broken) {
            ++told;
            CHECK(length(now->force) > 0.05);
            CHECK(length(now->force) < 0.0525);
        }
    }
    CHECK(told == 1);
    CHECK(scene.state().attachments.empty());
    CHECK(scene.state().holding.empty());
}

TEST_CASE("pins that may break do")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .breakForce = 0.02}};
    Scene scene(def);
    scene.stage.post(physics::SetGravity{{0, -10, 0}}); // 0.08 N
    scene.stage.run(100, 1e-3);
    CHECK(scene.state().held.empty());
    CHECK(scene.stage.soft().v[0].y < -0.1);
}

TEST_CASE("with either body goes what ties it to the other")
{
    for (const std::uint32_t gone : {1u, 2u, 3u}) {
        Scene scene;
        scene.stage.add(cube(0.02));
        scene.stage.add(rigidBox({0.05, 0.01, 0.01}, {0.01, 0.01, 0.01}, true));
        scene.attach({.to = {2}});
        scene.attachRigid({3}, {.to = {2}});
        scene.stage.run(3, 1e-3);
        REQUIRE(scene.state().held.size() == 2);
        scene.stage.post(physics::RemoveBody{{gone}});
        scene.stage.run(3, 1e-3);
        CHECK(scene.state().held.size() == (gone == 2 ? 0u : 1u));
        CHECK(scene.state().attachments.size() == scene.state().held.size());
        for (const frame::Attachment& each : scene.state().held)
            CHECK((each.body != BodyId{gone} && each.to != BodyId{gone}));
    }
}

TEST_CASE("a reset leaves attachments, and forgets their forces")
{
    Scene scene;
    scene.stage.add(rigidBox({0.03, 0.01, 0.01}, {0.01, 0.01, 0.01}, true));
    scene.attach({.within = 1e-4, .to = {2}});
    scene.attach({.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}});
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.step(1e-3);
    const std::uint64_t first = scene.stage.world.hash();
    scene.stage.run(50, 1e-3);
    scene.stage.post(physics::Reset{});
    scene.stage.step(0.0);
    for (const auto& forces : scene.state().holding)
        for (Vec3 force : forces) CHECK(force == Vec3{});
    scene.state().step = 0;
    scene.state().time = 0.0;
    scene.stage.step(1e-3);
    CHECK(scene.stage.world.hash() == first);
    CHECK(scene.state().held.size() == 2);
}

TEST_CASE("a grasp where nothing is touched is told, and waits for no later contact")
{
    Scene scene;
    scene.stage.add(rigidBox({0.2, 0, 0}));
    scene.stage.post(physics::Grasp{{1}, {2}, {1}, {}});
    CHECK_FALSE(scene.stage.step(0.0).has(physics::StepFlag::NothingAttached)); // paused: not yet
    CHECK(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
    CHECK(scene.state().grasps.empty());
    CHECK(scene.state().attachments.empty());
    REQUIRE(scene.warnings.size() == 1);
    CHECK_THAT(scene.warnings[0], Catch::StartsWith("rigid body 'box': grasp.target"));
    scene.stage.post(physics::Grasp{{2}, {2}, {1}, {}});
    scene.stage.post(physics::Release{{2}});
    CHECK_FALSE(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
}

TEST_CASE("contacts that a hard attachment holds leave it to that; a spring and they work together")
{
    for (const double stiffness : {physics::kHard, 100.0}) {
        physics::SoftBodyDef def = cube();
        def.collision = {{}};
        Scene scene(def);
        physics::RigidBodyDef tool = rigidBox({0.0295, 0.01, 0.01}, {0.01, 0.02, 0.02}); // half a millimetre inside
        tool.collision = {{}};
        scene.stage.add(tool);
        const AttachmentId id = scene.attach({.within = 1e-4, .stiffness = stiffness, .to = {2}});
        scene.stage.run(2000, 1e-3);
        REQUIRE(scene.held(id)->points == 9);
        CHECK(scene.state().touching.empty() == (stiffness == physics::kHard));
        CHECK(length(scene.held(id)->force) < (stiffness == physics::kHard ? 1e-6 : 1.0));
    }
}

TEST_CASE("two attachments that want different things of one node stay finite, and let it go quietly")
{
    for (const double speed : {1e-4, 0.01, 1.0}) { // [m/s] at which the tool goes away with a node that space holds
        Scene scene;
        scene.stage.add(rigidBox({0.03, 0.01, 0.01}));
        scene.attach({.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}});
        const AttachmentId id = scene.attach({.box = geometry::Box{{0.0199, -1, -1}, {1, 1, 1}}, .to = {2}});
        for (int i = 0; i < 1000; ++i) {
            scene.stage.post(physics::SetPose{{2}, 0, {{0.03 + 1e-3 * speed * i, 0.01, 0.01}, {}}});
            CHECK((scene.stage.step(1e-3).flags & static_cast<std::uint32_t>(physics::StepFlag::Undone)) == 0);
        }
        scene.stage.post(physics::Release{id});
        double fastest = 0.0;
        for (int i = 0; i < 1000; ++i) {
            scene.stage.step(1e-3);
            for (Vec3 v : scene.stage.soft().v) fastest = std::max(fastest, length(v));
        }
        CHECK(fastest < 5.0);
        for (std::size_t n = 0; n < 27; ++n)
            CHECK(distance(scene.stage.soft().x[n], scene.stage.model().rest[n]) < 1e-6);
    }
}

TEST_CASE("what is attached keeps its momentum, whatever integrates it")
{
    for (const bool isExplicit : {false, true}) {
        physics::SoftBodyDef def = cube(), other = cube(0.02);
        for (physics::SoftBodyDef* each : {&def, &other}) {
            each->rayleigh = {.mass = 0.0, .stiffness = 1e-4};
            if (isExplicit) each->integrator = physics::ExplicitEuler{.symplectic = true};
        }
        Scene scene(def);
        other.integrator = physics::ImplicitEuler{};
        scene.stage.add(other);
        physics::RigidBodyDef box = rigidBox({0.05, 0.01, 0.01}, {0.01, 0.01, 0.01}, true);
        box.velocity = {0.3, 0.2, -0.1};
        scene.stage.add(box);
        scene.attach({.within = 1e-4, .to = {2}});
        scene.attachRigid({3}, {.stiffness = 200.0, .to = {2}});
        scene.stage.run(400, 2e-4);
        Vec3 momentum = 0.008 * scene.state().rigidBodies[0].velocities[0];
        for (std::size_t b = 0; b < 2; ++b)
            for (std::size_t i = 0; i < 27; ++i) momentum += scene.stage.model(b).masses[i] * scene.stage.soft(b).v[i];
        CHECK(length(momentum - 0.008 * box.velocity) < 2e-3 * 0.008 * length(box.velocity));
    }
}

TEST_CASE("a tune that leaves attachments that cannot be stepped with is undone")
{
    Scene scene;
    scene.attach({.nodes = {0}});
    scene.stage.step(1e-3);
    const auto tuned = [&](const std::function<void(Model&, State&)>& change) {
        scene.stage.post(physics::Tune{[change](physics::PhysicsEngine& engine) {
            auto& world = dynamic_cast<World&>(engine);
            change(world.model(), world.state());
        }});
        return !scene.stage.step(1e-3).has(physics::StepFlag::TuneRejected);
    };
    CHECK(tuned([](Model&, State& state) { state.attachments[0].stiffness = 10.0; }));
    CHECK_FALSE(tuned([](Model&, State& state) { state.attachments[0].pairs[0][0].nodes[0].node = 27; }));
    CHECK_FALSE(tuned([](Model&, State& state) { state.attachments[0].to = {7}; }));
    CHECK_FALSE(tuned([](Model&, State& state) { state.attachments[0].breakForce = 0.0; }));
    CHECK_FALSE(tuned([](Model&, State& state) { state.holding.clear(); }));
    CHECK(scene.state().attachments[0].stiffness == 10.0);
}
