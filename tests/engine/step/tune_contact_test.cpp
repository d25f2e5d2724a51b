#include "filasofia/core/log.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"

#include "engine/stage.h"

#include <functional>
#include <limits>

namespace tune_contact_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A paused scene: a pinned soft block on a sheet, a rigid box attached to the block, and a waiting grasp.
struct Tuned {
    Stage stage;
    std::string logged;

    Tuned()
    {
        setLogSink([this](LogLevel, std::string_view line) { logged += line; });
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        physics::RigidBodyDef floor{.name = "floor", .mesh = sheet(), .collision = {{}}};
        stage.add(floor);
        physics::SoftBodyDef block{.name = "block", .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}))};
        block.pose.position = {-0.01, 0.0002, -0.01};
        block.attachments = {{.nodes = {20, 24}}};
        block.collision = {{}};
        stage.add(block);
        physics::RigidBodyDef box{.name = "box",
                                  .elements = {Pose{{0, 0.0225, 0}, {}}},
                                  .mesh = geometry::shapes::box({0.004, 0.004, 0.004}),
                                  .dynamic = true};
        box.attachments = {{.to = {2}}};
        box.collision = {{}};
        stage.add(box);
        stage.run(50, 1e-3);
        stage.post(physics::Grasp{{++stage.lastAttachment}, {3}, {2}, {}});
        stage.step(0.0);
        REQUIRE(!stage.world.scene().contacts.empty());
        REQUIRE(!stage.world.scene().sides.empty());
        REQUIRE(stage.world.scene().grasps.size() == 1);
    }
    Tuned(const Tuned&) = delete;
    ~Tuned() { setLogSink({}); }

    static std::shared_ptr<const geometry::TriangleMesh> sheet()
    {
        geometry::TriangleMesh mesh;
        mesh.vertices = {{-0.02, 0, -0.02}, {-0.02, 0, 0.02}, {0.02, 0, 0.02}, {0.02, 0, -0.02}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        return std::make_shared<const geometry::TriangleMesh>(mesh);
    }

    /// The logged error; empty if the tune was accepted.
    std::string refusal(const std::function<void(Scene&)>& change)
    {
        logged.clear();
        stage.post(physics::Tune{[change](physics::PhysicsEngine& engine) {
            auto& world = dynamic_cast<World&>(engine);
            change(world.scene());
        }});
        const bool rejected = stage.step(0.0).has(physics::StepFlag::TuneRejected);
        CHECK(rejected == !logged.empty());
        return logged;
    }
};

/// Changes a copy of a surface's shape.
void reshape(CollisionModel& model, const std::function<void(CollisionShape&)>& change)
{
    CollisionShape shape = *model.shape;
    change(shape);
    model.shape = std::make_shared<const CollisionShape>(std::move(shape));
}

} // namespace

TEST_CASE("a tune that leaves invalid collision models, contacts, sides, grasps or pins is rolled back")
{
    using Change = std::function<void(Scene&)>;
    const std::pair<Change, const char*> wrong[] = {
        {[](Scene& s) { s.soft[0].model.friction = kNan; }, "soft body 'block': friction"},
        {[](Scene& s) { s.soft[0].model.collision[0].shape = nullptr; }, "collision[0]: must have a shape"},
        {[](Scene& s) { s.soft[0].model.collision[0].proximity = -1; }, "collision[0]: proximity"},
        {[](Scene& s) { s.soft[0].model.collision[0].inset.depth.pop_back(); }, "inset.depth must have"},
        {[](Scene& s) { s.soft[0].model.collision[0].inset.depth[3] = kNan; }, "inset.depth must be >= 0"},
        {[](Scene& s) { s.soft[0].model.collision[0].inset.share.clear(); }, "inset.share must have"},
        {[](Scene& s) { s.soft[0].model.collision[0].embedding.nodes.pop_back(); }, "embedding.nodes must have"},
        {[](Scene& s) { s.soft[0].model.collision[0].embedding.nodes[2][1] = 27; }, "in [0, 27), got 27"},
        {[](Scene& s) { s.soft[0].model.collision[0].embedding.weights[2][1] = kNan; }, "weights must be finite"},
        {[](Scene& s) { s.soft[0].model.collision[0].behind[5] = -1; }, "behind must be in [0, 27), got -1"},
        {[](Scene& s) { s.soft[0].model.collision[0].behind.pop_back(); }, "behind must have"},
        {[](Scene& s) { s.soft[0].model.collision.clear(); }, "no such surface"},
        {[](Scene& s) { s.rigid[1].model.collision[0].element = 1; }, "element must be in [0, 1), got 1"},
        {[](Scene& s) { s.rigid[1].model.collision[0].core[0].x = kNan; }, "core must be finite"},
        {[](Scene& s) { s.rigid[1].model.collision[0].core.clear(); }, "core must have"},
        {[](Scene& s) { s.rigid[1].model.collision.resize(2049); }, "<= 2048 entries, got 2049"},
        {[](Scene& s) {
             reshape(s.rigid[1].model.collision[0], [](CollisionShape& shape) { shape.triangles[3][1] = 8; });
         },
         "triangles must be in [0, 8), got 8"},
        {[](Scene& s) {
             reshape(s.rigid[1].model.collision[0], [](CollisionShape& shape) { shape.nodes[0].first = 0; });
         },
         "nodes[0] must be a leaf"},
        {[](Scene& s) {
             reshape(s.rigid[1].model.collision[0], [](CollisionShape& shape) { shape.vertexEdges.start[2] = 99; });
         },
         "vertexEdges must hold consecutive rows"},
        {[](Scene& s) {
             reshape(s.rigid[1].model.collision[0], [](CollisionShape& shape) { shape.elements[0].ownEdges[0] = 99; });
         },
         "ownEdges must be in"},
        {[](Scene& s) { s.contacts[0].second = {77}; }, "contacts[0]: body 2 or body 77: no such surface"},
        {[](Scene& s) { s.contacts[0].feature = ~0ull; }, "no such surface"},
        {[](Scene& s) { s.contacts[0].force.x = kNan; }, "contacts[0]: point and force must be finite"},
        {[](Scene& s) { std::ranges::reverse(s.contacts); }, "contacts must ascend"},
        {[](Scene& s) { s.sides[0].target.model = 1; }, "sides[0]"},
        {[](Scene& s) { s.sides[0].point = 999; }, "point must be a vertex, got 999"},
        {[](Scene& s) { s.sides[0].feature[0] = 4; }, "feature must consist of vertices or -1, got 4"},
        {[](Scene& s) { s.sides[0].side = 0; }, "side must be 1 or -1, got 0"},
        {[](Scene& s) { std::ranges::reverse(s.sides); }, "sides must ascend"},
        {[](Scene& s) { s.grasps[0].target = {}; }, "grasp 3: must name a target"},
        {[](Scene& s) { s.grasps[0].target = {77}; }, "grasp 3: body 77: no such body"},
        {[](Scene& s) { s.grasps[0].target = {3}; }, "two bodies, got body 3 twice"},
        {[](Scene& s) { s.grasps[0].rigid = {2}, s.grasps[0].target = {3}; }, "only a rigid body can grasp"},
        {[](Scene& s) { s.grasps[0].stiffness = 0; }, "grasp 3: stiffness must be > 0 N/m"},
        {[](Scene& s) { s.grasps[0].breakForce = kNan; }, "grasp 3: breakForce must be > 0 N"},
        {[](Scene& s) { s.grasps[0].id = {}; }, "grasps must ascend by their ids"},
        {[](Scene& s) { s.attachments[0].to = {3}; }, "two bodies, got body 3 twice"},
        {[](Scene& s) { s.attachments[0].id = {}; }, "its id must be > 0"},
        {[](Scene& s) { s.attachments[0].body = {1}, s.attachments[0].to = {}; }, "cannot be attached"},
        {[](Scene& s) {
             s.soft[0].model.pins.groups[0].nodes = {24, 20};
         },
         "nodes must ascend"},
        {[](Scene& s) {
             s.soft[0].model.pins.groups[0].nodes = {20, 27};
         },
         "in [0, 27), got 27"},
        {[](Scene& s) { s.soft[0].model.pins.groups[0].stiffness = 0; }, "stiffness must be > 0 N/m, got 0"},
    };
    Tuned twin, tuned;
    setLogSink([&](LogLevel, std::string_view line) { tuned.logged += line; });
    for (const auto& [change, says] : wrong) {
        CHECK_THAT(tuned.refusal(change), Catch::Contains("tune() was rolled back") && Catch::Contains(says));
        CHECK(tuned.stage.world.hash() == twin.stage.world.hash());
    }
    CHECK(tuned.refusal([](Scene&) {}).empty());
    for (int i = 0; i < 10; ++i) { // the model is rolled back too
        twin.stage.step(1e-3);
        tuned.stage.step(1e-3);
        REQUIRE(tuned.stage.world.hash() == twin.stage.world.hash());
    }
}

TEST_CASE("a surface that a tune replaces has no history")
{
    Tuned scene;
    CHECK(scene.refusal([](Scene& s) { reshape(s.rigid[0].model.collision[0], [](CollisionShape&) {}); }).empty());
    CHECK(scene.stage.world.scene().sides.empty());
    for (const CachedContact& each : scene.stage.world.scene().contacts)
        CHECK((each.first != BodyId{1} && each.second != BodyId{1}));
    CHECK_FALSE(scene.stage.step(1e-3).has(physics::StepFlag::Undone));
}

} // namespace tune_contact_test
