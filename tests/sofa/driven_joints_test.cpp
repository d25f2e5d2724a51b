#include "sofa/driven_jaw.h"

#include "filasofia/sofa/tune.h"

#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/simulation/AnimateEndEvent.h>
#include <sofa/simulation/Node.h>

// Joints that forces move, and bodies with joints whose base forces move, on both engines.
namespace driven_joints_test {

using namespace filasofia;
using namespace filasofia::driven_jaw;

namespace {

/// A component that throws when a step has been made.
class Throwing final : public ::sofa::core::objectmodel::BaseObject {
public:
    SOFA_CLASS(Throwing, ::sofa::core::objectmodel::BaseObject);
    Throwing() { f_listening.setValue(true); }
    void handleEvent(::sofa::core::objectmodel::Event* event) override
    {
        if (::sofa::simulation::AnimateEndEvent::checkEventType(event)) throw std::runtime_error("out of order");
    }
};

Vec3 momentumOf(PhysicsServer& server, BodyId body, const RigidBodyDef& def)
{
    const auto frame = server.latest();
    const auto& tool = *frame->rigidBody(body);
    const std::vector<RigidInertia> inertias = linkInertias(def);
    Vec3 sum;
    for (std::size_t e = 0; e < inertias.size(); ++e) {
        const Vec3 arm = rotate(tool.poses[e].orientation, inertias[e].centre);
        sum += inertias[e].mass * (tool.velocities[e] + cross(tool.angularVelocities[e], arm));
    }
    return sum;
}

} // namespace

TEST_CASE("a jaw that swings has the period of its pendulum")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, 1e-4);
    const double tilt = 0.05;
    const BodyId body = server->add(jaw(JointForce{}, -kPi / 2 + tilt));
    const double period = 2 * kPi * std::sqrt(kAboutHinge / (kMass * kG * kArm)) * (1 + tilt * tilt / 16);
    double first = 0.0, last = 0.0, before = tilt;
    int crossings = 0;
    for (int i = 1; i <= 20000 && crossings < 3; ++i) {
        server->step(1e-4);
        const double angle = joint(*server, body).position + kPi / 2;
        if (before < 0.0 && angle >= 0.0) (crossings++ == 0 ? first : last) = 1e-4 * (i - angle / (angle - before));
        before = angle;
    }
    REQUIRE(crossings == 3);
    CHECK((last - first) / 2 == Approx(period).epsilon(1e-3));
}

TEST_CASE("driven, told and carried joints move as in the native engine", "[slow]")
{
    std::vector<std::vector<double>> seen;
    for (const std::string engine : {"native", "sofa"}) {
        const auto server = serverWith(engine, kDt);
        RigidBodyDef def = jaw(JointForce{1e-3}, 0.2);
        def.articulation.joints[0].damping = 1e-5;
        JointDef slider{.kind = JointKind::Prismatic, .axis = {1, 1, 0}, .parent = 1, .child = 2, .damping = 0.3};
        slider.mass = GivenInertia{.mass = 0.01, .centre = {0.004, 0, 0.002}, .moments = {1e-6, 2e-6, 2e-6}};
        slider.command = JointForce{0.02};
        slider.inertia = 0.005;
        JointDef told{.axis = {0, 1, 0}, .parent = 2, .child = 3, .start = 0.1, .speed = 2.0};
        told.mass = GivenInertia{.mass = 0.005, .moments = {1e-6, 1e-6, 1e-6}};
        def.articulation.joints.insert(def.articulation.joints.end(), {slider, told});
        const BodyId tool = server->add(def);
        const BodyId flying = server->add(freeTool(JointForce{1e-4}));
        std::vector<double>& values = seen.emplace_back();
        std::shared_ptr<const SavedState> saved;
        for (int i = 1; i <= 300; ++i) {
            server->setPose(tool, {{1e-4 * i, 0.1, 0}, axisAngle({0, 1, 0}, 1e-3 * i)});
            if (i == 50) server->setJoint(tool, 2, JointPosition{-0.4});
            if (i == 80) server->setWrench(flying, {0.01, 0, 0.02}, {0, 1e-4, 0});
            if (i == 100) server->setJoint(tool, 0, JointPosition{0.5});
            if (i == 150) server->setJoint(tool, 0, JointForce{-2e-3});
            if (i == 160) saved = server->save();
            if (i == 200) server->restore(*saved);
            if (i == 250) server->reset();
            server->step(kDt);
            const auto frame = server->latest();
            for (const BodyId each : {tool, flying})
                for (const frame::Joint& now : frame->rigidBody(each)->joints)
                    values.insert(values.end(), {now.position, now.velocity});
            for (const BodyId each : {tool, flying})
                for (const Pose& pose : frame->rigidBody(each)->poses)
                    values.insert(values.end(), {pose.position.x, pose.position.y, pose.position.z});
        }
    }
    REQUIRE(seen[0].size() == seen[1].size());
    for (std::size_t i = 0; i < seen[0].size(); ++i) REQUIRE(seen[1][i] == Approx(seen[0][i]).margin(1e-9));
}

TEST_CASE("a driven joint comes to rest at its stop, which bears what is left of force and weight")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool upper = GENERATE(false, true);
    CAPTURE(engine, upper);
    const auto server = serverWith(engine, kDt);
    RigidBodyDef def = jaw(JointForce{upper ? 0.02 : -0.01});
    def.articulation.joints[0].lower = -0.4;
    def.articulation.joints[0].upper = 0.7;
    const BodyId body = server->add(def);
    for (int i = 0; i < 500; ++i) {
        REQUIRE((server->step(kDt).flags & ~static_cast<std::uint32_t>(StepFlag::NotConverged)) == 0);
        REQUIRE(joint(*server, body).position >= -0.4);
        REQUIRE(joint(*server, body).position <= 0.7);
    }
    const frame::Joint now = joint(*server, body);
    CHECK(now.position == Approx(upper ? 0.7 : -0.4).epsilon(1e-6));
    CHECK(now.velocity == Approx(0.0).margin(1e-6));
    CHECK(now.force == (upper ? 0.02 : -0.01));
    const double weight = -kMass * kG * kArm * std::cos(now.position);
    CHECK(now.stop == Approx(-(now.force + weight)).epsilon(1e-3));
    server->setJoint(body, 0, JointForce{upper ? -0.02 : 0.02}); // it leaves the stop at once
    steps(*server, 30, kDt);
    CHECK(joint(*server, body).stop == 0.0);
    CHECK(std::abs(joint(*server, body).position - now.position) > 0.05);
}

TEST_CASE("dry friction holds a driven joint up to its limit, and slows a faster one by it")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = jaw(JointForce{0.004});
    def.articulation.joints[0].friction = 0.005;
    const BodyId body = server->add(def);
    steps(*server, 500, kDt);
    CHECK(std::abs(joint(*server, body).position) < 1e-3);
    CHECK(std::abs(joint(*server, body).velocity) < 1e-6);
    server->setJoint(body, 0, JointForce{0.006});
    steps(*server, 100, kDt);
    CHECK(joint(*server, body).velocity == Approx(0.1 * 0.001 / kAboutHinge).epsilon(0.02));
    server->setJoint(body, 0, JointForce{0.0});
    steps(*server, 200, kDt);
    CHECK(std::abs(joint(*server, body).velocity) < 1e-6);
}

TEST_CASE("a free tool with a joint falls with its weight, keeps its momentum, and hangs from what it is attached to")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = freeTool(JointForce{1e-4});
    def.velocity = {0.1, 0.0, 0.05};
    const BodyId body = server->add(def);
    server->step(kDt);
    const Vec3 before = momentumOf(*server, body, def);
    steps(*server, 200, kDt);
    CHECK(std::abs(joint(*server, body).velocity) > 0.1); // the joint has moved
    CHECK(length(momentumOf(*server, body, def) - before) < 0.02 * length(before));

    server->reset();
    server->setJoint(body, 0, JointPosition{0.0});
    server->step(kDt);
    const Vec3 start = momentumOf(*server, body, def);
    server->setGravity({0, -kG, 0});
    steps(*server, 100, kDt);
    CHECK(length(momentumOf(*server, body, def) - start - Vec3{0, -0.07 * kG * 0.1, 0}) < 1e-3 * 0.07);

    server->reset();
    RigidBodyDef handle{.name = "handle", .mesh = geometry::shapes::box({0.01, 0.01, 0.01})};
    const BodyId hand = server->add(handle);
    server->step(kDt);
    server->setJoint(body, 0, JointPosition{0.0});
    const AttachmentId held = server->attach(body, RigidAttachmentDef{.to = hand});
    steps(*server, 500, kDt);
    const auto frame = server->latest();
    CHECK(length(frame->rigidBody(body)->poses[0].position) < 2e-3);
    for (const frame::Attachment& each : frame->attachments)
        if (each.id == held) CHECK(each.force.y == Approx(0.07 * kG).epsilon(0.01));
}

TEST_CASE("a driven joint that diverges rests, with a flag, and can be used again")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    RigidBodyDef def = jaw(JointForce{1e9});
    def.articulation.joints[0].kind = JointKind::Prismatic;
    def.articulation.joints[0].axis = {1, 0, 0};
    const BodyId body = server->add(def);
    bool undone = false;
    for (int i = 0; i < 3; ++i) undone = server->step(kDt).has(StepFlag::Undone) || undone;
    CHECK(undone);
    CHECK(std::isfinite(joint(*server, body).position));
    CHECK(joint(*server, body).velocity == 0.0);
    server->setJoint(body, 0, JointPosition{0.01});
    for (int i = 0; i < 2000; ++i) REQUIRE_FALSE(server->step(kDt).has(StepFlag::Undone));
    CHECK(joint(*server, body).position == 0.01);
}

TEST_CASE("a step that fails in SOFA leaves driven joints where they were, at rest")
{
    const auto server = serverWith("sofa", kDt, {});
    const BodyId body = server->add(jaw(JointForce{1e-3})), flying = server->add(freeTool(JointForce{1e-4}));
    steps(*server, 50, kDt);
    const double before = joint(*server, body).position;
    REQUIRE(joint(*server, body).velocity > 0.1);
    const auto throwing = ::sofa::core::objectmodel::New<Throwing>();
    const auto listen = [&](bool on) {
        sofaengine::tune(*server, [&, on](::sofa::simulation::Node& root, const auto&) {
            if (on) root.addObject(throwing);
            if (!on) root.removeObject(throwing);
        });
    };
    listen(true);
    CHECK(server->step(kDt).has(StepFlag::Undone));
    CHECK(joint(*server, body).position == before);
    CHECK(joint(*server, body).velocity == 0.0);
    CHECK(length(server->latest()->rigidBody(flying)->velocities[0]) == 0.0);
    listen(false);
    CHECK_FALSE(server->step(kDt).has(StepFlag::Undone));
    CHECK(joint(*server, body).position > before);
}

TEST_CASE("a free tool that goes on turning is told as restless, though its joint is driven", "[slow]")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, 1e-2, {});
    RigidBodyDef def = freeTool(JointForce{});
    def.articulation.joints[0].damping = 1e-3;
    def.angularVelocity = {0, 0, 1};
    const BodyId body = server->add(def);
    bool restless = false;
    StepReport report;
    for (int i = 0; i < 800 && !restless; ++i) {
        report = server->step(1e-2);
        restless = report.has(StepFlag::Restless);
    }
    CHECK(restless);
    CHECK(report.unrest.body == body);
}

TEST_CASE("by penalties joints that forces move are refused, and told ones are not")
{
    auto engine = runtime::makeEngine("sofa", {.period = kDt, .threads = 1, .contact = PenaltyContact{}});
    PhysicsServer server(std::move(engine));
    CHECK_THROWS_WITH(server.add(jaw(JointForce{1e-3})),
                      Catch::StartsWith("rigid body 'jaw': articulation: joints that forces move are not available"));
    CHECK_THROWS_WITH(server.add(freeTool(JointPosition{})), Catch::Contains("joints that forces move"));
    const BodyId body = server.add(jaw(JointPosition{}));
    CHECK_THROWS_WITH(server.setJoint(body, 0, JointForce{1e-3}), Catch::Contains("joints that forces move"));
    server.setJoint(body, 0, JointPosition{0.1});
    server.step(kDt);
}

} // namespace driven_joints_test
