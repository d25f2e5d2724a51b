#include "sofa/sofa_stage.h"

#include "filasofia/core/log.h"
#include "filasofia/core/text.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/sofa/tune.h"

#include <sofa/component/mapping/linear/BarycentricMapping.h>
#include <sofa/simulation/Node.h>

// Contact with either engine: against the same closed forms, with bounds per engine.
namespace contact_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

using Mapping = ::sofa::component::mapping::linear::BarycentricMapping<::sofa::defaulttype::Vec3Types,
                                                                       ::sofa::defaulttype::Vec3Types>;

constexpr double kG = 9.81, kDt = 1e-3;

RigidBodyDef rigidBox(const std::string& name, Vec3 half, Pose pose, double friction = 0.5)
{
    RigidBodyDef def{.name = name, .elements = {pose}, .mesh = geometry::shapes::box(2.0 * half)};
    def.dynamic = true;
    def.friction = friction;
    def.collision = {{}};
    return def;
}

RigidBodyDef floorDef(double friction = 0.5, Quat tilt = {})
{
    RigidBodyDef def = rigidBox("floor", {0.5, 0.05, 0.5}, {rotate(tilt, {0, -0.05, 0}), tilt}, friction);
    def.dynamic = false;
    return def;
}

SoftBodyDef tissue(const std::string& name, Vec3 size, Vec3 corner, int cells = 4)
{
    SoftBodyDef def{.name = name,
                    .mesh = bar(cells, cells, cells, size),
                    .pose = {corner, {}},
                    .material = FemMaterial{.youngModulus = 2e4, .law = Corotational{}},
                    .solver = Cholesky{}};
    def.collision = {{}};
    def.friction = 0.5;
    return def;
}

Vec3 forceOn(PhysicsServer& server, BodyId body) { return frame::forceOn(body, server.latest()->contacts); }

/// [N] The mean contact force on a body over a number of steps.
Vec3 meanForce(PhysicsServer& server, BodyId body, int count, double dt = kDt)
{
    Vec3 sum;
    for (int i = 0; i < count; ++i) {
        server.step(dt);
        sum += forceOn(server, body);
    }
    return sum / count;
}

const double kWeight = 8 * 0.02 * 0.02 * 0.02 * 1000 * kG; // [N] a box of 4 cm

} // namespace

TEST_CASE("a body at rest presses on a floor with its weight")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool soft = GENERATE(false, true);
    CAPTURE(engine, soft);
    const auto server = serverWith(engine, kDt);
    const BodyId floor = server->add(floorDef());
    const BodyId body = soft ? server->add(tissue("block", {0.04, 0.04, 0.04}, {-0.017, 0.0004, -0.021}))
                             : server->add(rigidBox("box", {0.02, 0.02, 0.02}, {{0.003, 0.0204, -0.001}, {}}));
    steps(*server, 1000, kDt);
    const Vec3 force = meanForce(*server, body, 200);
    CAPTURE(force.x, force.y, force.z);
    CHECK(length(force - Vec3{0, kWeight, 0}) < 0.02 * kWeight);
    CHECK(length(forceOn(*server, floor) + forceOn(*server, body)) < 1e-9);
    const auto frame = server->latest();
    for (const frame::Contact& contact : frame->contacts) {
        CHECK(contact.normal.y == Approx(contact.first == floor ? -1.0 : 1.0).margin(0.02));
        CHECK(length(contact.friction) <= (engine == "sofa" ? 0.51 : 0.5) * contact.normalForce + 1e-6);
        CHECK(std::abs(contact.point.y) < 1e-3);
    }
}

TEST_CASE("a box on a slope slides if the tangent of the slope exceeds the friction by 3 %, and not if it is 3 % less")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    for (const double tangent : {0.485, 0.515}) { // mu = 0.5
        CAPTURE(engine, tangent);
        const double angle = std::atan(tangent);
        const Quat tilt = axisAngle({0, 0, 1}, -angle);
        const auto server = serverWith(engine, kDt);
        server->add(floorDef(0.5, tilt));
        const BodyId box =
            server->add(rigidBox("box", {0.02, 0.01, 0.02}, {rotate(tilt, {0.003, 0.0103, -0.002}), tilt}));
        steps(*server, 300, kDt);
        const auto at = [&] { return server->latest()->rigidBody(box)->poses[0].position; };
        const auto speed = [&] { return length(server->latest()->rigidBody(box)->velocities[0]); };
        const Vec3 before = at();
        const double slow = speed();
        steps(*server, 500, kDt);
        CAPTURE(length(at() - before), speed(), slow);
        if (tangent < 0.5)
            CHECK(length(at() - before) < 1e-5);
        else
            CHECK((speed() - slow) / 0.5 == Approx(kG * (std::sin(angle) - 0.5 * std::cos(angle))).epsilon(0.05));
    }
}

TEST_CASE("a told ball that is pressed into tissue feels the same force with either engine")
{
    double force[2];
    int e = 0;
    for (const std::string engine : {"native", "sofa"}) {
        const auto server = serverWith(engine, kDt);
        SoftBodyDef def = tissue("tissue", {0.06, 0.03, 0.06}, {-0.03, -0.03, -0.03}, 6);
        def.gravity = false;
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.03 + 1e-6, 1}}}};
        const BodyId body = server->add(def);
        RigidBodyDef ball{
            .name = "ball", .elements = {{{0.0011, 0.013, 0.0007}, {}}}, .mesh = geometry::shapes::sphere(0.012, 4)};
        ball.collision = {{}};
        const BodyId tool = server->add(ball);
        for (int i = 1; i <= 200; ++i) {
            server->setPose(tool, {{0.0011, 0.013 - 0.004 * i / 200, 0.0007}, {}});
            server->step(kDt);
        }
        force[e] = meanForce(*server, tool, 100).y;
        CHECK(force[e] > 0.05);
        CHECK(length(forceOn(*server, tool) + forceOn(*server, body)) < 1e-9);
        ++e;
    }
    CAPTURE(force[0], force[1]);
    CHECK(force[1] == Approx(force[0]).epsilon(0.15));
}

TEST_CASE("boxes stand on each other, and tissue on tissue")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool soft = GENERATE(false, true);
    CAPTURE(engine, soft);
    const auto server = serverWith(engine, kDt);
    server->add(floorDef());
    std::vector<BodyId> tower;
    for (int k = 0; k < 2; ++k) {
        const double height = 0.0004 + 0.0404 * k;
        tower.push_back(soft ? server->add(tissue(text("block ", k), {0.04, 0.04, 0.04}, {-0.02, height, -0.02}, 3))
                             : server->add(rigidBox(text("box ", k), {0.02, 0.02, 0.02}, {{0, height + 0.02, 0}, {}})));
    }
    steps(*server, 300, kDt);
    for (const BodyId each : tower) {
        const Vec3 force = meanForce(*server, each, 100);
        CAPTURE(each.value, force.x, force.y, force.z);
        CHECK(length(force - Vec3{0, kWeight, 0}) < 0.02 * kWeight);
    }
}

TEST_CASE("a box that is placed within its skin comes out of it without a hop")
{
    const auto server = serverWith("sofa", kDt);
    server->add(floorDef());
    const BodyId box = server->add(rigidBox("box", {0.02, 0.02, 0.02}, {{0, 0.02005, 0}, {}}));
    double highest = 0.0, fastest = 0.0;
    for (int i = 0; i < 200; ++i) {
        server->step(kDt);
        const auto frame = server->latest();
        highest = std::max(highest, frame->rigidBody(box)->poses[0].position.y);
        fastest = std::max(fastest, length(frame->rigidBody(box)->velocities[0]));
    }
    CHECK(highest < 0.02025);
    CHECK(fastest < 0.015);
    CHECK(server->latest()->rigidBody(box)->poses[0].position.y == Approx(0.0202).margin(2e-5)); // two skins of 0.1 mm
}

TEST_CASE("only models of the same group meet, and a model of its own may differ from the body's surface")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt);
    server->add(floorDef());
    RigidBodyDef stranger = rigidBox("stranger", {0.02, 0.02, 0.02}, {{-0.2, 0.0204, 0}, {}}), tall = stranger;
    stranger.collision[0].group = 1;
    tall.name = "tall"; // stands on a box that is higher than its own surface
    tall.elements = {{{0.2, 0.0304, 0}, {}}};
    tall.collision[0].mesh = geometry::shapes::box({0.04, 0.06, 0.04});
    SoftBodyDef sunk = tissue("sunk", {0.04, 0.04, 0.04}, {0, -0.0046, 0}, 2);
    geometry::TriangleMesh inner = *geometry::shapes::box({0.03, 0.03, 0.03});
    for (Vec3& vertex : inner.vertices) vertex += Vec3{0.02, 0.02, 0.02};
    sunk.collision[0].mesh = std::make_shared<const geometry::TriangleMesh>(inner); // 5 mm below its own
    const BodyId a = server->add(stranger), b = server->add(tall), c = server->add(sunk);
    steps(*server, 400, kDt);
    const auto frame = server->latest();
    CHECK(frame->rigidBody(a)->poses[0].position.y < -0.5); // it fell through
    CHECK(frame->rigidBody(b)->poses[0].position.y == Approx(0.03).margin(3e-4));
    CHECK(std::ranges::min(frame->softBody(c)->positions, {}, &Vec3::y).y == Approx(-0.005).margin(1e-3));
}

TEST_CASE("tissue that is told to meets itself, and otherwise passes through itself")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    for (const bool self : {true, false}) {
        CAPTURE(engine, self);
        // Two bars in one mesh, one above the other: the lower is held.
        geometry::TetMesh two = *bar(2, 2, 2, {0.02, 0.02, 0.02});
        const auto count = static_cast<int>(two.nodes.size());
        const std::size_t tetrahedra = two.tetrahedra.size();
        for (int i = 0; i < count; ++i)
            two.nodes.push_back(two.nodes[static_cast<std::size_t>(i)] + Vec3{0.003, 0.022, 0.002});
        for (std::size_t t = 0; t < tetrahedra; ++t) {
            two.tetrahedra.push_back(two.tetrahedra[t]);
            for (int& node : two.tetrahedra.back()) node += count;
        }
        SoftBodyDef def = tissue("bars", {}, {});
        def.mesh = std::make_shared<const geometry::TetMesh>(two);
        def.collision[0].self = self;
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
        const auto server = serverWith(engine, kDt);
        const BodyId body = server->add(def);
        if (!self) server->add(floorDef()); // so that there is contact at all
        steps(*server, 150, kDt);
        const double top = server->latest()->softBody(body)->positions.back().y;
        if (self)
            CHECK(top > 0.038);
        else
            CHECK(top < 0.03);
    }
}

TEST_CASE("a penalty bears the weight, and its contacts are springs")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = std::make_unique<PhysicsServer>(
        runtime::makeEngine(engine, {.period = kDt, .threads = 1, .contact = PenaltyContact{.stiffness = 2000.0}}),
        PhysicsServerDef{.gravity = {0, -kG, 0}});
    server->add(floorDef());
    SoftBodyDef block = tissue("block", {0.04, 0.04, 0.04}, {-0.017, 0.001, -0.021});
    if (engine == "sofa")
        CHECK_THROWS_WITH(server->add(block), Catch::StartsWith("soft body 'block': solver: a matrix and collision by "
                                                                "PenaltyContact are not available together"));
    block.solver = ConjugateGradient{};
    block.rayleigh = {.mass = 5.0, .stiffness = 0.01};
    const BodyId body = server->add(block);
    steps(*server, 1500, kDt);
    const Vec3 force = meanForce(*server, body, 100);
    CAPTURE(force.x, force.y, force.z);
    CHECK(force.y == Approx(kWeight).epsilon(0.02));
    if (engine == "native") return; // its gaps are those of the start of the step
    for (const frame::Contact& contact : server->latest()->contacts)
        CHECK(contact.normalForce == Approx(std::max(0.0, -2000.0 * contact.gap)).margin(1e-12));
}

TEST_CASE("the damping of a penalty is refused before a step")
{
    CHECK_THROWS_WITH(runtime::makeEngine("sofa", {.contact = PenaltyContact{.damping = 1.0}}),
                      Catch::Contains("damping of a PenaltyContact is not available with the engine 'sofa'"));
}

TEST_CASE("each engine tells once that friction has no effect by penalty")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    for (int i = 0; i < 2; ++i) {
        const auto server = std::make_unique<PhysicsServer>(
            runtime::makeEngine("sofa", {.period = kDt, .contact = PenaltyContact{.stiffness = 2000.0}}),
            PhysicsServerDef{});
        server->add(floorDef(0.0)); // has none
        server->add(rigidBox("box", {0.02, 0.02, 0.02}, {}, 0.4));
        server->add(rigidBox("other", {0.02, 0.02, 0.02}, {{1, 0, 0}, {}}, 0.4));
        steps(*server, 2, kDt);
    }
    setLogSink({});
    REQUIRE(lines.size() == 2);
    CHECK_THAT(lines[0], Catch::Contains("rigid body 'box': friction 0.4 has no effect: contacts by PenaltyContact"));
    CHECK(lines[1] == lines[0]);
}

TEST_CASE("what SOFA makes for a contact does not hold itself: it goes with the contact")
{
    const bool exact = GENERATE(true, false);
    CAPTURE(exact);
    ContactMethod method = ExactContact{};
    if (!exact) method = PenaltyContact{.stiffness = 2000.0};
    const auto server = std::make_unique<PhysicsServer>(runtime::makeEngine("sofa", {.period = kDt, .contact = method}),
                                                        PhysicsServerDef{});
    server->add(floorDef(0.0));
    RigidBodyDef box = rigidBox("box", {0.02, 0.02, 0.02}, {{0, 0.0201, 0}, {}}, 0.0);
    box.elements[0].orientation = axisAngle({0, 1, 0}, 0.3);
    server->add(box);
    std::size_t mappings = 0, holding = 0;
    for (int i = 0; i < 20; ++i) {
        sofaengine::tune(*server, [&](::sofa::simulation::Node& root, const sofaengine::NodeOf&) {
            std::vector<Mapping*> all;
            root.getTreeObjects<Mapping>(&all);
            mappings += all.size();
            for (const Mapping* each : all) holding += each->getSlaves().size();
        });
        server->step(kDt);
    }
    CHECK(mappings > 0);
    CHECK(holding == 0);
}

TEST_CASE("bodies in contact come and go a thousand times, and engines with contact fifty times")
{
    {
        const auto server = serverWith("sofa", kDt);
        server->add(floorDef());
        const BodyId block = server->add(tissue("block", {0.02, 0.02, 0.02}, {0, 0.0002, 0}, 2));
        for (int i = 0; i < 500; ++i) { // two a time
            const double x = 0.001 * (i % 10);
            const BodyId box = server->add(rigidBox("box", {0.01, 0.01, 0.01}, {{x, 0.0304, 0.01}, {}}));
            const BodyId soft = server->add(tissue("soft", {0.01, 0.01, 0.01}, {-0.05, 0.0002, x}, 1));
            const StepReport report = server->step(kDt);
            REQUIRE(report.contacts.active > 0);
            REQUIRE_FALSE(report.has(StepFlag::Undone));
            server->remove(i % 2 == 0 ? box : soft);
            server->step(kDt);
            server->remove(i % 2 == 0 ? soft : box);
        }
        steps(*server, 200, kDt);
        CHECK(meanForce(*server, block, 100).y == Approx(kWeight / 8).epsilon(0.05));
    }
    for (int i = 0; i < 50; ++i) {
        const auto server = serverWith("sofa", kDt);
        server->add(floorDef());
        server->add(tissue("block", {0.02, 0.02, 0.02}, {0, 0.0002, 0}, 2));
        CHECK(steps(*server, 2, kDt).contacts.active > 0);
    }
}

TEST_CASE("a body whose state is not finite is undone in contact too, and the others go on")
{
    const auto server = serverWith("sofa", kDt);
    server->add(floorDef());
    const BodyId calm = server->add(tissue("calm", {0.04, 0.04, 0.04}, {-0.017, 0.0003, -0.021}));
    SoftBodyDef wild = tissue("wild", {0.02, 0.02, 0.02}, {0.2, 0.0003, 0}, 2);
    wild.forces = {{.node = 0, .force = {1e300, 0, 0}}};
    const BodyId thrown = server->add(wild);
    CHECK(server->step(kDt).has(StepFlag::Undone));
    server->setForces(thrown, {});
    steps(*server, 1000, kDt);
    CHECK(meanForce(*server, calm, 100).y == Approx(kWeight).epsilon(0.02));
    CHECK(meanForce(*server, thrown, 100).y == Approx(kWeight / 8).epsilon(0.02));
}

TEST_CASE("explicit nodes, several told elements, and reset")
{
    const auto server = serverWith("sofa", 2e-4);
    RigidBodyDef plates = floorDef();
    plates.mesh = geometry::shapes::box({0.1, 0.01, 0.1});
    plates.elements = {{{0, -0.005, 0}, {}}, {{0.5, -0.005, 0}, {}}};
    plates.collision = {{}, {.element = 1}};
    const BodyId told = server->add(plates);
    SoftBodyDef block = tissue("block", {0.02, 0.02, 0.02}, {-0.01, 0.0003, -0.01}, 2);
    block.integrator = ExplicitEuler{.symplectic = true};
    block.rayleigh = {.mass = 10.0, .stiffness = 0.0};
    SoftBodyDef other = block;
    other.pose.position.x = 0.49;
    const BodyId a = server->add(block), b = server->add(other);
    steps(*server, 3000, 2e-4);
    CHECK(meanForce(*server, a, 500, 2e-4).y == Approx(kWeight / 8).epsilon(0.05));
    for (int i = 1; i <= 500; ++i) { // the second plate rises
        server->setPose(told, {{0.5, -0.005 + 1e-5 * i, 0}, {}}, 1);
        server->step(2e-4);
    }
    const auto frame = server->latest();
    CHECK(frame->softBody(b)->positions[0].y > frame->softBody(a)->positions[0].y + 4e-3);
    server->reset();
    server->step(2e-4);
    CHECK(server->latest()->softBody(a)->positions[0].y == Approx(0.0003).margin(1e-5));
}

} // namespace contact_test
