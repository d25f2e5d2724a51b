#include "sofa/driven_jaw.h"

// Joints that forces move in contact with other bodies, on both engines.
namespace jaw_contact_test {

using namespace filasofia;
using namespace filasofia::driven_jaw;

TEST_CASE("a torque that bears the weight keeps a jaw where it is, and one on a slider its load")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt);
    const BodyId body = server->add(jaw(JointForce{kMass * kG * kArm}));
    RigidBodyDef lift = jaw(JointForce{kMass * kG + 0.008 * kG}); // its own weight and a stone's, on top of it
    lift.name = "lift";
    lift.elements[0].position = {1, 0, 0};
    lift.articulation.joints[0].kind = JointKind::Prismatic;
    lift.articulation.joints[0].axis = {0, 1, 0};
    lift.articulation.joints[0].childOffset = {};
    lift.articulation.joints[0].damping = 1.0;
    lift.collision = {{.mesh = geometry::shapes::box({0.04, 0.004, 0.04}), .element = 1}};
    const BodyId lifting = server->add(lift);
    RigidBodyDef stone{.name = "stone", .elements = {{{1, 0.0122, 0}, {}}}, .dynamic = true};
    stone.mesh = geometry::shapes::box({0.02, 0.02, 0.02});
    stone.collision = {{}};
    server->add(stone);
    steps(*server, 100, kDt);
    CHECK(std::abs(joint(*server, body).position) < 1e-9); // in balance from the start
    steps(*server, 400, kDt);
    CHECK(joint(*server, lifting).load == Approx(-0.008 * kG).epsilon(0.02));
    CHECK(std::abs(joint(*server, lifting).velocity) < 1e-4);
}

TEST_CASE("a jaw that closes with a torque stalls on tissue, which bears that torque", "[slow]")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = plate(JointForce{-0.01}, 0.01);
    def.articulation.joints[0].damping = 1e-4;
    const BodyId body = server->add(def);
    SoftBodyDef cushion{.name = "cushion",
                        .mesh = bar(4, 3, 3, {0.04, 0.02, 0.03}),
                        .pose = {{0.012, -0.0225, -0.015}, {}},
                        .material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4, .law = Corotational{}},
                        .rayleigh = {.mass = 1.0, .stiffness = 5e-3},
                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0224, 1}}}},
                        .collision = {{}}};
    server->add(cushion);
    steps(*server, 600, kDt);
    double load = 0.0;
    for (int i = 0; i < 100; ++i) {
        server->step(kDt);
        load += joint(*server, body).load / 100;
    }
    CHECK(load == Approx(0.01).epsilon(0.02));
    CHECK(joint(*server, body).position < -5e-3);
    CHECK(std::abs(joint(*server, body).velocity) < 0.02);
}

TEST_CASE("a jaw passes the angular momentum that it loses to a free box")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = plate(JointForce{-0.02}, 0.3);
    def.friction = 0.0;
    const BodyId body = server->add(def);
    RigidBodyDef box{.name = "box", .elements = {{{0.035, -0.02, 0.002}, {}}}, .dynamic = true};
    box.mesh = geometry::shapes::box({0.02, 0.02, 0.02});
    box.friction = 0.0;
    box.mass = TotalMass{0.01};
    box.collision = {{}};
    const BodyId other = server->add(box);
    steps(*server, 20, kDt);
    server->setJoint(body, 0, JointForce{});
    server->step(kDt);
    const RigidInertia inertia = inertiaOf(box);
    const auto spin = [&] { // about the hinge
        const auto frame = server->latest();
        const auto& stone = *frame->rigidBody(other);
        const Vec3 w = stone.angularVelocities[0];
        const Mat3 r = toMat3(stone.poses[0].orientation);
        return kAboutHinge * joint(*server, body).velocity +
               cross(stone.poses[0].position, inertia.mass * stone.velocities[0]).z +
               (r * inertia.inertia * transpose(r) * w).z;
    };
    const double before = spin();
    bool touched = false;
    for (int i = 0; i < 100; ++i) {
        server->step(kDt);
        touched = touched || joint(*server, body).load != 0.0;
    }
    CHECK(touched);
    CHECK(length(server->latest()->rigidBody(other)->velocities[0]) > 0.1);
    CHECK(spin() == Approx(before).epsilon(0.01));
}

TEST_CASE("jaws of one body stop at each other if they are told to meet, and pass through each other otherwise")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool self = GENERATE(true, false);
    CAPTURE(engine, self);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = plate(JointForce{-0.01}, 0.5);
    def.articulation.joints[0].damping = 1e-3;
    def.articulation.joints.push_back(def.articulation.joints[0]);
    def.articulation.joints[1].child = 2;
    def.articulation.joints[1].start = -0.5;
    def.articulation.joints[1].command = JointForce{0.01};
    def.collision.push_back(def.collision[0]);
    def.collision[1].element = 2;
    for (CollisionDef& each : def.collision) each.self = self;
    const BodyId body = server->add(def);
    bool undone = false;
    for (int i = 0; i < 300; ++i) undone = server->step(kDt).has(StepFlag::Undone) || undone;
    CHECK_FALSE(undone);
    const double between = joint(*server, body, 0).position - joint(*server, body, 1).position;
    if (!self) {
        CHECK(between < -0.5);
        return;
    }
    CHECK(between > 0.2); // their inner edges touch at 0.4
    CHECK(joint(*server, body, 0).load == Approx(0.01).epsilon(0.05));
    CHECK(joint(*server, body, 1).load == Approx(-0.01).epsilon(0.05));
}

TEST_CASE("a tool that pushes a jaw against its stop leaves it there, with a bounded load")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = plate(JointForce{});
    def.articulation.joints[0].lower = -0.5;
    def.articulation.joints[0].upper = 0.5;
    const BodyId body = server->add(def);
    RigidBodyDef tool{.name = "tool", .elements = {{{0.03, 0.03, 0}, {}}}, .collision = {{}}};
    tool.mesh = geometry::shapes::box({0.02, 0.02, 0.02});
    const BodyId pushes = server->add(tool);
    double most = 0.0;
    for (int i = 0; i < 1500; ++i) {
        server->setPose(pushes, {{0.03, 0.03 - 3e-5 * i, 0}, {}});
        server->step(kDt);
        const frame::Joint now = joint(*server, body);
        REQUIRE((now.position >= -0.5 && now.position <= 0.5));
        most = std::max({most, std::abs(now.load), std::abs(now.stop)});
    }
    CHECK(joint(*server, body).position < -0.3); // native leaves the tool before
    CHECK(most < 100.0);
}

} // namespace jaw_contact_test
