#include "engine/stage.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"

namespace contacts_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

physics::RigidBodyDef rigidBox(Vec3 half, Pose pose, bool dynamic = true)
{
    physics::RigidBodyDef def{.elements = {pose}, .mesh = geometry::shapes::box(2.0 * half)};
    def.dynamic = dynamic;
    def.collision = {{}};
    return def;
}

physics::SoftBodyDef softBlock(std::array<int, 3> cells, Vec3 size, Vec3 corner)
{
    physics::SoftBodyDef def{.mesh = shared(boxMesh(cells, size))};
    def.pose.position = corner;
    def.collision = {{}};
    return def;
}

double lowest(const SoftState& state) { return std::ranges::min(state.x, {}, &Vec3::y).y; }

/// A stage with a floor and gravity.
Stage onFloor(const physics::ContactMethod& method = physics::ExactContact{})
{
    Stage stage({.threads = 1, .contact = method});
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    physics::RigidBodyDef floor = rigidBox({0.2, 0.02, 0.2}, {{0, -0.02, 0}, {}}, false);
    floor.name = "floor";
    stage.add(floor);
    return stage;
}

} // namespace

TEST_CASE("a penalty contact carries the weight at the depth that its stiffness gives")
{
    Stage stage = onFloor(physics::PenaltyContact{.stiffness = 2000.0, .damping = 5.0});
    stage.add(rigidBox({0.02, 0.02, 0.02}, {{0.003, 0.0201, 0.001}, {}}));
    stage.run(3000, 1e-3);
    const double weight = 8 * 8e-6 * 1000 * 9.81;
    double force = 0.0;
    for (const frame::Contact& contact : stage.world.scene().contactReports) force += contact.normalForce;
    CHECK(force == Approx(weight).epsilon(0.01));
    const double depth = 0.02 - stage.world.scene().rigid[1].state.poses[0].position.y;
    CHECK(depth == Approx(weight / (4 * 2000.0)).margin(2e-5)); // four corners; minus the skin
}

TEST_CASE("damping does not change the weight that a body puts on the floor")
{
    Stage stage = onFloor();
    physics::RigidBodyDef box = rigidBox({0.02, 0.02, 0.02}, {{0.003, 0.0201, 0.001}, {}});
    box.linearDamping = 50.0;
    box.angularDamping = 50.0;
    stage.add(box);
    stage.run(2000, 1e-3);
    double force = 0.0;
    for (const frame::Contact& contact : stage.world.scene().contactReports) force += contact.normalForce;
    CHECK(force == Approx(8 * 8e-6 * 1000 * 9.81).epsilon(1e-3));
}

TEST_CASE("a body may have a separate collision surface that moves with it")
{
    Stage stage = onFloor();
    physics::SoftBodyDef coarse = softBlock({2, 2, 2}, {0.04, 0.04, 0.04}, {-0.02, 0.003, -0.02});
    geometry::TriangleMesh fine = geometry::extractSurface(boxMesh({7, 7, 7}, {0.04, 0.04, 0.04})).mesh;
    for (Vec3& p : fine.vertices) p.y = 0.04 + 1.05 * (p.y - 0.04); // extends 2 mm below the body
    coarse.collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(fine)}};
    stage.add(coarse);
    stage.run(1500, 1e-3);
    CHECK(lowest(stage.soft()) == Approx(0.002).margin(3e-4)); // on its own surface, not on its nodes
    CHECK(stage.world.scene().contactReports.size() > 20);
}

TEST_CASE("proximities too small to tell inside from outside, and an inside-out mesh, log warnings")
{
    for (const double proximity : {0.0, 4e-5, 6e-5})
        for (const bool insideOut : {false, true}) {
            std::string logged;
            setLogSink([&](LogLevel, std::string_view line) { logged += line; });
            Stage stage;
            geometry::TriangleMesh mesh = *geometry::shapes::box({0.1, 0.1, 0.1});
            for (geometry::Triangle& t : mesh.triangles)
                if (insideOut) std::swap(t[0], t[1]);
            physics::RigidBodyDef floor{.name = "floor", .elements = {{{0, -0.05, 0}, {}}}};
            floor.collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(mesh), .proximity = proximity}};
            stage.add(floor);
            physics::RigidBodyDef box = rigidBox({0.01, 0.01, 0.01}, {{0, 0.011, 0}, {}});
            box.collision[0].proximity = proximity;
            stage.add(box);
            stage.step(1e-3);
            setLogSink({});
            const auto says = [&](const char* words) { return logged.find(words) != std::string::npos; };
            CHECK(says("proximities of their collision models add up to") == (proximity < 5e-5));
            CHECK(says("rigid body 'floor': collision[0].mesh is turned inside out") == insideOut);
        }
}

TEST_CASE("only models of one group touch")
{
    for (const int group : {0, 7}) {
        std::string logged;
        setLogSink([&](LogLevel, std::string_view line) { logged += line; });
        Stage stage = onFloor();
        physics::RigidBodyDef box = rigidBox({0.01, 0.01, 0.01}, {{0, 0.011, 0}, {}});
        box.collision[0].group = group;
        stage.add(box);
        stage.run(300, 1e-3);
        CHECK((stage.world.scene().rigid[1].state.poses[0].position.y > 0.0) == (group == 0));
        CHECK(stage.world.scene().contactReports.empty() == (group != 0));
        setLogSink({});
        CHECK((logged.find("rigid body 'floor': no other body has collision group 0") != std::string::npos) ==
              (group != 0));
        CHECK((logged.find("no other body has collision group 7: it collides with nothing") != std::string::npos) ==
              (group != 0));
    }
}

TEST_CASE("tissue that falls since only blades meet it is told so")
{
    for (const bool alone : {true, false})
        for (const bool held : {false, true}) {
            std::string logged;
            setLogSink([&](LogLevel, std::string_view line) { logged += line; });
            Stage stage = onFloor();
            physics::SoftBodyDef def{.name = "tissue", .mesh = shared(boxMesh({1, 1, 1}, {0.02, 0.02, 0.02}))};
            def.pose.position = {0, 0.02, 0};
            def.collision = {{.cutting = true}};
            if (!alone) def.collision.emplace_back();
            if (held) def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.0201, 1}}}};
            stage.add(def);
            stage.step(1e-3);
            setLogSink({});
            const bool told = logged.find("all its collision models have `cutting`") != std::string::npos;
            CHECK(told == (alone && !held));
        }
}

TEST_CASE("a body that collides among bodies that do not is told to collide with nothing")
{
    // A floor whose collision was forgotten: the box fell through it for ever, without a word.
    for (const bool floor : {false, true}) {
        std::string logged;
        setLogSink([&](LogLevel, std::string_view line) { logged += line; });
        Stage stage;
        if (floor) stage.add(physics::RigidBodyDef{.mesh = geometry::shapes::box({1.0, 0.1, 1.0})});
        stage.add(rigidBox({0.01, 0.01, 0.01}, {{0, 0.011, 0}, {}}));
        stage.step(1e-3);
        setLogSink({});
        CHECK((logged.find("it collides with nothing") != std::string::npos) == floor);
    }
}

TEST_CASE("only what would be borne otherwise is told that it collides with nothing")
{
    // Blades that cut bodies without collision models, a vessel with a clip, and tools about pinned tissue were told
    // so.
    enum Case { Blade, Needle, Vessel, Tool, Floor, Air };
    for (const Case which : {Blade, Needle, Vessel, Tool, Floor, Air}) {
        std::string logged;
        setLogSink([&](LogLevel, std::string_view line) { logged += line; });
        Stage stage;
        if (which != Vessel) stage.post(physics::SetGravity{{0, -9.81, 0}});
        physics::SoftBodyDef soft = softBlock({2, 2, 2}, {0.04, 0.04, 0.04}, {-0.02, 0.003, -0.02});
        if (which != Vessel) soft.collision = {};
        if (which != Floor) soft.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.004, 1}}}};
        physics::RigidBodyDef tool = rigidBox({0.2, 0.02, 0.2}, {{0, 0.2, 0}, {}}, which == Needle || which == Air);
        if (which == Blade) tool.collision = {{.cutting = true}};
        if (which == Needle) tool.needle = physics::NeedleDef{.line = {{0, 0, 0}, {0, 0.01, 0}}, .radius = 1e-3};
        const physics::RigidBodyDef clip{.mesh = geometry::shapes::sphere(0.01), .dynamic = true};
        const physics::RigidBodyDef table{.mesh = geometry::shapes::box({1.0, 0.1, 1.0})};
        stage.add(which == Air ? physics::BodyDef(table) : physics::BodyDef(soft));
        stage.add(which == Vessel ? clip : tool);
        stage.step(1e-3);
        setLogSink({});
        CAPTURE(static_cast<int>(which), logged);
        CHECK((logged.find("it collides with nothing") != std::string::npos) == (which == Floor || which == Air));
    }
}

TEST_CASE("the collision models of one body do not collide with each other")
{
    Stage stage = onFloor();
    physics::RigidBodyDef two = rigidBox({0.01, 0.01, 0.01}, {{0, 0.012, 0}, {}});
    two.collision = {{.mesh = geometry::shapes::box(2.0 * Vec3{0.01, 0.01, 0.01})},
                     {.mesh = geometry::shapes::box(2.0 * Vec3{0.004, 0.012, 0.004})}};
    stage.add(two);
    stage.run(500, 1e-3);
    CHECK(stage.world.scene().rigid[1].state.poses[0].position.y == Approx(0.012).margin(1e-4));
    for (const frame::Contact& contact : stage.world.scene().contactReports) CHECK(contact.first != contact.second);
}

TEST_CASE("a tool at 1 m/s does not go through a membrane of 2 mm")
{
    for (const double dt : {1e-3, 2e-3}) {
        Stage stage;
        physics::SoftBodyDef membrane = softBlock({12, 1, 12}, {0.06, 0.002, 0.06}, {-0.03, 0, -0.03});
        membrane.gravity = false;
        membrane.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.029, 1, 1}}},
                                {.box = geometry::Box{{0.029, -1, -1}, {1, 1, 1}}}};
        stage.add(membrane);
        physics::RigidBodyDef tool{.name = "tool", .elements = {Pose{{0.001, 0.012, 0.0005}, {}}}};
        tool.mesh = geometry::shapes::sphere(0.005, 8);
        tool.collision = {{}};
        const BodyId id = stage.add(tool);
        double penetration = 0.0;
        for (int i = 1; i * dt <= 0.015; ++i) { // 15 mm down: 8 mm into the membrane
            stage.post(physics::SetPose{id, 0, Pose{{0.001, 0.012 - i * dt, 0.0005}, {}}});
            penetration = std::max(penetration, stage.step(dt).contacts.penetration);
        }
        double under = 1.0; // the membrane's highest point under the ball's centre
        for (std::size_t n = 0; n < stage.soft().x.size(); ++n)
            if (const Vec3 p = stage.soft().x[n]; std::hypot(p.x, p.z) < 0.004) under = std::min(under, p.y);
        CHECK(under < -0.003 - 0.005 + 0.0005);
        CHECK(penetration < 6e-4);
    }
}

TEST_CASE("a body that folds onto itself stops at itself")
{
    Stage stage = onFloor();
    // A U of soft material on its side; its upper arm falls onto the lower one.
    geometry::TetMesh mesh = boxMesh({12, 5, 2}, {0.06, 0.025, 0.01});
    std::erase_if(mesh.tetrahedra, [&](const geometry::Tetrahedron& t) {
        Vec3 centre;
        for (int node : t) centre += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
        return centre.x > 0.01 && centre.y > 0.01 && centre.y < 0.015;
    });
    std::vector<int> number(mesh.nodes.size(), -1);
    std::vector<Vec3> nodes;
    for (geometry::Tetrahedron& t : mesh.tetrahedra)
        for (int& node : t) {
            int& n = number[static_cast<std::size_t>(node)];
            if (n < 0) {
                n = static_cast<int>(nodes.size());
                nodes.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
            }
            node = n;
        }
    mesh.nodes = nodes;
    for (const bool self : {false, true}) {
        Stage fold = onFloor();
        physics::SoftBodyDef def{.mesh = shared(mesh)};
        def.pose.position = {-0.03, 0.0001, -0.005};
        def.material = physics::FemMaterial{.youngModulus = 700.0};
        def.collision = {{.self = self}};
        fold.add(def);
        fold.run(800, 1e-3);
        bool met = false;
        for (const frame::Contact& contact : fold.world.scene().contactReports)
            met = met || (contact.first == contact.second && contact.normalForce > 0.0);
        CHECK(met == self);
    }
}

TEST_CASE("tissue crushed between two rigid tools recovers after they open")
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    stage.add(softBlock({4, 4, 4}, {0.02, 0.02, 0.02}, {-0.0103, -0.01, -0.0098}));
    std::array<BodyId, 2> jaws;
    const auto place = [](int jaw, double gap) {
        return Pose{{0, jaw == 0 ? 0.01 + 0.5 * gap : -0.01 - 0.5 * gap, 0}, {}};
    };
    for (int jaw : {0, 1}) {
        physics::RigidBodyDef def = rigidBox({0.008, 0.01, 0.03}, place(jaw, 0.021), false);
        def.name = text("jaw ", jaw);
        jaws[static_cast<std::size_t>(jaw)] = stage.add(def);
    }
    int inverted = 0;
    std::size_t most = 0;
    for (int i = 0; i < 1500; ++i) { // to zero in 0.3 s, and open again
        const double gap = i < 400 ? std::max(0.0, 0.021 - 0.00007 * i) : std::min(0.06, 0.0001 * (i - 400));
        for (int jaw : {0, 1}) stage.post(physics::SetPose{jaws[static_cast<std::size_t>(jaw)], 0, place(jaw, gap)});
        CHECK_FALSE(stage.step(1e-3).has(physics::StepFlag::Undone));
        inverted = std::max(inverted, invertedElements(stage.model(), stage.soft()));
        most = std::max(most, stage.world.scene().contactReports.size());
    }
    CHECK(inverted > 0); // it was crushed
    CHECK(most < 400);
    CHECK(invertedElements(stage.model(), stage.soft()) == 0);
    for (Vec3 x : stage.soft().x) CHECK(isFinite(x));
}

TEST_CASE("a chain of ten boxes that are welded together stays stiff under its weight")
{
    for (const double dt : {1e-3, 5e-3}) {
        Stage stage;
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        BodyId last;
        for (int k = 0; k < 10; ++k) {
            physics::RigidBodyDef box = rigidBox({0.02, 0.01, 0.01}, {{0.04 * k, 0, 0}, {}});
            box.collision.clear();
            box.attachments = {{.to = last}}; // the first is attached to space
            last = stage.add(box);
        }
        stage.run(static_cast<int>(2.0 / dt), dt);
        const RigidState& tip = stage.world.scene().rigid.back().state;
        CHECK(distance(tip.poses[0].position, {0.36, 0, 0}) < 1e-6);
        CHECK(length(tip.velocities[0]) < 1e-6);
        CHECK(stage.world.scene().attachmentReports[0].force.y == Approx(10 * 1.6e-5 * 1000 * 9.81).epsilon(1e-4));
    }
}

TEST_CASE("contacts end with their bodies, and neither reset nor pause leaves any behind")
{
    Stage stage = onFloor();
    const BodyId box = stage.add(rigidBox({0.01, 0.01, 0.01}, {{0, 0.0101, 0}, {}}));
    stage.run(50, 1e-3);
    REQUIRE(!stage.world.scene().contactReports.empty());
    const std::uint64_t before = stage.world.hash();
    stage.step(0.0); // paused
    CHECK(stage.world.hash() == before);
    CHECK(!stage.world.scene().contactReports.empty());
    stage.post(physics::Reset{});
    stage.step(0.0);
    CHECK(stage.world.scene().contactReports.empty());
    stage.run(50, 1e-3);
    stage.post(physics::RemoveBody{box});
    stage.step(1e-3);
    CHECK(stage.world.scene().contactReports.empty());
    CHECK(stage.world.scene().contacts.empty());
}

TEST_CASE("a run that is reset in contact repeats its trajectory")
{
    Stage stage = onFloor();
    stage.add(softBlock({3, 3, 3}, {0.03, 0.03, 0.03}, {-0.015, 0.001, -0.015}));
    stage.step(0.0);
    const Snapshot start(stage.world.scene());
    std::vector<std::vector<Vec3>> ends;
    for (int k = 0; k < 2; ++k) {
        stage.run(100, 1e-3);
        ends.push_back(stage.soft().x);
        stage.post(physics::Reset{});
        stage.step(0.0);
    }
    CHECK(ends[0] == ends[1]);
}

TEST_CASE("a coupled solve that a deadline cuts short stays finite and can be replayed")
{
    std::int64_t clock = 0;
    physics::StepBudget budget{.now = [&] { return clock += 1000; }, .deadline = 0};
    std::vector<std::vector<int>> iterations;
    std::vector<std::uint64_t> hashes;
    for (int k = 0; k < 2; ++k) {
        Stage stage = onFloor();
        stage.add(softBlock({5, 5, 5}, {0.04, 0.04, 0.04}, {-0.02, 0.002, -0.02}));
        stage.add(softBlock({2, 2, 2}, {0.02, 0.02, 0.02}, {-0.01, 0.044, -0.012}));
        for (int i = 0; i < 300; ++i) {
            physics::StepBudget mine = budget;
            mine.deadline = clock + 20000; // enough for a few reads of the clock
            if (k == 1) mine = {.iterations = iterations[static_cast<std::size_t>(i)]};
            const physics::StepReport report =
                stage.world.step({.dt = 1e-3, .commands = stage.commands, .budget = &mine});
            stage.commands.clear();
            CHECK_FALSE(report.has(physics::StepFlag::Undone));
            if (k == 1) continue;
            iterations.emplace_back();
            for (const physics::BodySolve& solve : report.solves) iterations.back().push_back(solve.iterations);
        }
        CHECK(lowest(stage.soft()) > -0.003);
        hashes.push_back(stage.world.hash());
    }
    CHECK(hashes[0] == hashes[1]);
}

} // namespace contacts_test
