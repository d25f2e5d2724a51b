#include "sofa/sofa_stage.h"

#include "filasofia/geometry/shapes.h"

// Joints: those that are told where to go, and those that attachments make of rigid bodies.
namespace joints_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

constexpr double kG = 9.81, kDt = 1e-3;

RigidBodyDef stone(Vec3 place, Vec3 size = {0.02, 0.02, 0.02})
{
    return {.name = "stone", .elements = {{place, {}}}, .mesh = geometry::shapes::box(size), .dynamic = true};
}
double weightOf(Vec3 size) { return size.x * size.y * size.z * 1000 * kG; }

/// A shaft with an arm on a hinge, and a slider on the arm.
RigidBodyDef instrument()
{
    RigidBodyDef def{.name = "instrument", .elements = {{{0, 0.1, 0}, axisAngle({0, 1, 0}, 0.2)}}};
    def.mesh = geometry::shapes::box({0.01, 0.01, 0.04});
    JointDef hinge{.axis = {0, 0, 2}, .start = 0.1, .speed = 2.0};
    hinge.lower = -1.0;
    hinge.upper = 1.0;
    hinge.parentOffset = {{0.01, 0, 0}, axisAngle({1, 0, 0}, 0.3)};
    hinge.childOffset.position = {-0.03, 0, 0};
    JointDef slider{.kind = JointKind::Prismatic, .axis = {1, 0, 0}, .parent = 1, .child = 2, .speed = 0.05};
    slider.command = JointPosition{0.004};
    def.articulation.joints = {hinge, slider};
    return def;
}

} // namespace

TEST_CASE("the joints of a told body move its links as in the native engine, and with them what follows it")
{
    std::vector<std::vector<Vec3>> seen;
    std::vector<std::vector<double>> joints;
    for (const std::string engine : {"native", "sofa"}) {
        const auto server = serverWith(engine, kDt);
        const BodyId tool = server->add(instrument());
        RigidBodyDef jaw = instrument();
        jaw.name = "jaw";
        jaw.articulation.to = tool;
        jaw.articulation.offset.position = {0, 0.01, 0};
        const BodyId second = server->add(jaw);
        server->setJoint(tool, 0, JointPosition{-0.6});
        std::vector<Vec3>& points = seen.emplace_back();
        std::vector<double>& values = joints.emplace_back();
        std::shared_ptr<const SavedState> saved;
        for (int i = 1; i <= 600; ++i) {
            server->setPose(tool, {{0.0001 * i, 0.1, 0}, axisAngle({0, 1, 0}, 0.2 + 0.001 * i)});
            if (i == 200) server->setJoint(second, 1, JointPosition{-0.003});
            if (i == 300) saved = server->save();
            if (i == 400) server->restore(*saved);
            if (i == 500) server->reset();
            server->step(kDt);
            const auto frame = server->latest();
            for (const BodyId each : {tool, second})
                for (const Pose& pose : frame->rigidBody(each)->poses) {
                    points.push_back(pose.position);
                    points.push_back(rotate(pose.orientation, {1, 2, 3}));
                }
            for (const auto& joint : frame->rigidBody(tool)->joints) {
                values.push_back(joint.position);
                values.push_back(joint.velocity);
            }
        }
    }
    REQUIRE(seen[0].size() == seen[1].size());
    REQUIRE(joints[0].size() == joints[1].size());
    for (std::size_t i = 0; i < seen[0].size(); ++i) REQUIRE(length(seen[0][i] - seen[1][i]) < 1e-9);
    for (std::size_t i = 0; i < joints[0].size(); ++i) REQUIRE(joints[0][i] == Approx(joints[1][i]).margin(1e-9));
}

TEST_CASE("a told joint tells what its link bears")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt);
    RigidBodyDef tool{.name = "tool", .elements = {{}}, .mesh = geometry::shapes::box({0.01, 0.01, 0.01})};
    JointDef hinge{}; // about z
    hinge.childOffset.position = {-0.05, 0, 0};
    tool.articulation.joints = {hinge};
    const BodyId arm = server->add(tool);
    const BodyId load = server->add(stone({0.08, 0, 0}));
    server->attach(load, RigidAttachmentDef{.points = {{0, 0, 0}}, .to = arm, .toElement = 1});
    steps(*server, 300, kDt);
    const double moment = 0.08 * weightOf({0.02, 0.02, 0.02});
    const auto& joint = server->latest()->rigidBody(arm)->joints[0];
    CHECK(joint.load == Approx(-moment).epsilon(0.01));
    CHECK(joint.force == Approx(moment).epsilon(0.01));
}

TEST_CASE("one point is a ball joint, two are a hinge: a rod swings with the period of its pendulum")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool hinge = GENERATE(false, true);
    CAPTURE(engine, hinge);
    const auto server = serverWith(engine, 1e-4);
    const Vec3 size{0.01, 0.1, 0.01};
    RigidBodyDef rod = stone({}, size);
    const double tilt = 0.05;
    const Quat turn = axisAngle({0, 0, 1}, tilt);
    rod.elements = {{rotate(turn, {0, -0.05, 0}), turn}};
    const BodyId body = server->add(rod);
    std::vector<Vec3> points{{0, 0.05, 0}};
    if (hinge) points = {{0, 0.05, -0.02}, {0, 0.05, 0.02}};
    server->attach(body, RigidAttachmentDef{.points = points});
    const double inertia = (0.1 * 0.1 + 0.01 * 0.01) / 12 + 0.05 * 0.05; // per mass, about the joint
    const double period = 2 * M_PI * std::sqrt(inertia / (kG * 0.05)) * (1 + tilt * tilt / 16);
    double first = 0.0, last = 0.0, before = 0.0;
    int crossings = 0;
    for (int i = 1; i <= 15000; ++i) {
        server->step(1e-4);
        const double x = server->latest()->rigidBody(body)->poses[0].position.x;
        if (before < 0.0 && x >= 0.0) {
            (crossings++ == 0 ? first : last) = 1e-4 * (i - x / (x - before));
            if (crossings == 3) break;
        }
        before = x;
    }
    REQUIRE(crossings == 3);
    CHECK((last - first) / 2 == Approx(period).epsilon(2e-3));
}

TEST_CASE("an element that is attached as a whole keeps its position and its orientation")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const int to = GENERATE(0, 1, 2); // space, a told body that turns, tissue
    CAPTURE(engine, to);
    const auto server = serverWith(engine, kDt);
    const BodyId body = server->add(stone({0.03, 0.01, 0.01}));
    RigidBodyDef told = stone({}, {0.01, 0.01, 0.01});
    told.dynamic = false;
    const BodyId other = server->add(told);
    SoftBodyDef soft{.name = "tissue",
                     .mesh = bar(2, 2, 2, {0.02, 0.02, 0.02}),
                     .material = FemMaterial{.youngModulus = 1e6, .law = Corotational{}},
                     .rayleigh = {.mass = 5.0, .stiffness = 0.01}};
    soft.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    const BodyId tissue = server->add(soft);
    server->attach(body, RigidAttachmentDef{.to = to == 0 ? BodyId{} : to == 1 ? other : tissue});
    for (int i = 1; i <= 300; ++i) {
        if (to == 1) server->setPose(other, {{}, axisAngle({0, 0, 1}, 0.002 * i)});
        server->step(kDt);
    }
    const Quat turn = to == 1 ? axisAngle({0, 0, 1}, 0.6) : Quat{};
    const Pose pose = server->latest()->rigidBody(body)->poses[0];
    CHECK(length(pose.position - rotate(turn, {0.03, 0.01, 0.01})) < (to == 2 ? 2e-3 : 1e-4));
    CHECK(length(rotationVector(pose.orientation * conjugate(turn))) < (to == 2 ? 0.1 : 5e-3));
    const auto frame = server->latest();
    REQUIRE(frame->attachments.size() >= 1);
    CHECK(frame->attachments.back().points == 4);
}

} // namespace joints_test
