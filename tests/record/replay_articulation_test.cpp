#include "engine/meshes.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "record/round_trip.h"
#include "record/runs.h"

namespace replay_articulation_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

/// A shaft on a holder, and two jaws, all elements listed in the Def.
RigidBodyDef gripper(BodyId holder)
{
    RigidBodyDef def{.name = "gripper", .mesh = geometry::shapes::box({0.03, 0.004, 0.02}), .friction = 0.8};
    def.articulation.to = holder;
    def.articulation.offset = {{-0.01, 0, 0}, {}};
    for (const double side : {1.0, -1.0}) {
        JointDef& jaw = def.articulation.joints.emplace_back();
        jaw.child = side > 0.0 ? 1 : 2;
        jaw.childOffset.position.x = -0.02;
        jaw.lower = side > 0.0 ? 0.0 : -0.8;
        jaw.upper = side > 0.0 ? 0.8 : 0.0;
        jaw.start = side * 0.6;
        jaw.damping = 1e-4;
        jaw.friction = 1e-5;
        def.collision.push_back({.element = jaw.child});
    }
    return def;
}

/// Two jaws close on a loose cube, one by force and one by position; the holder lifts them and is removed.
template <class AfterStep> void run(PhysicsServer& server, AfterStep&& afterStep)
{
    server.keepLog(true);
    server.hashEveryStep(true);
    const BodyId holder = server.add(RigidBodyDef{.name = "holder"});
    const BodyId tool = server.add(gripper(holder));
    SoftBodyDef cube{.mesh = shared(boxMesh({2, 2, 2}, {0.01, 0.01, 0.01})), .gravity = false, .collision = {{}}};
    cube.pose.position = {0.004, -0.005, -0.005};
    const BodyId soft = server.add(cube);
    for (int step = 0; step < 160; ++step) {
        if (step == 2) server.setJoint(tool, 0, JointForce{-0.005});
        if (step == 2) server.setJoint(tool, 1, JointForce{0.005});
        if (step == 60) server.setJoint(tool, 1, JointPosition{-0.3});
        if (step == 70) server.grasp(tool, soft);
        if (step >= 70 && step < 100) server.setPose(holder, {{0, 1e-4 * (step - 69), 0}, {}});
        if (step == 100) server.remove(holder);
        if (step == 110) server.setPose(tool, {{0, 0.0035, 0}, {}});
        if (step == 120) server.pause(true);
        if (step == 122) server.pause(false);
        if (step == 130) server.reset();
        server.step(1e-3);
        afterStep(step);
    }
}

} // namespace

TEST_CASE("a session with joints, from a file, is replayed with the same hash at every step")
{
    const record::ScratchFile file("joints.rec");
    bool touched = false;
    {
        PhysicsServer server(engine::makeNativeEngine({.threads = 1}));
        record::RecordingWriter writer(file.path(), {});
        run(server, [&](int) {
            const auto frame = server.latest();
            REQUIRE(frame->rigidBodies.back().joints.size() == 2);
            touched = touched || frame->rigidBodies.back().joints[0].load != 0.0;
            const StepRecord& step = *server.nextRecord();
            CHECK_FALSE(step.report.has(StepFlag::NothingAttached));
            writer.write(step);
            server.popRecord();
        });
    }
    CHECK(touched);
    const record::Recording recording = record::readRecording(file.path());
    CHECK(recording.steps.size() == 160);
    for (const int threads : {1, 3})
        CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.threads = threads})));
}

TEST_CASE("joints and their commands come back from a file bit for bit")
{
    using namespace record_test;
    const auto set = roundTrip(SetJoint{BodyId{3}, 2, JointForce{kThird}});
    CHECK((set.id == BodyId{3} && set.joint == 2));
    CHECK(sameBits(std::get<JointForce>(set.command).value, kThird));
    CHECK(sameBits(std::get<JointPosition>(roundTrip(SetJoint{BodyId{3}, 0, JointPosition{kTiny}}).command).value,
                   kTiny));

    RigidBodyDef def{.name = "tool"};
    def.articulation = {.joints = {{.kind = JointKind::Prismatic,
                                    .axis = kVec,
                                    .parent = 4,
                                    .child = 5,
                                    .parentOffset = kPose,
                                    .childOffset = kPose,
                                    .lower = -kThird,
                                    .start = kTiny,
                                    .command = JointForce{kLarge},
                                    .speed = kThird,
                                    .damping = kTiny,
                                    .friction = kLarge,
                                    .inertia = kThird,
                                    .mass = GivenInertia{.mass = kThird}},
                                   {}},
                        .to = BodyId{9},
                        .toElement = 3,
                        .offset = kPose};
    const ArticulationDef back = roundTrip(def).articulation;
    CHECK((back.to == BodyId{9} && back.toElement == 3 && sameBits(back.offset, kPose)));
    REQUIRE(back.joints.size() == 2);
    const JointDef& joint = back.joints[0];
    CHECK((joint.kind == JointKind::Prismatic && joint.parent == 4 && joint.child == 5));
    CHECK((sameBits(joint.axis, kVec) && sameBits(joint.parentOffset, kPose) && sameBits(joint.childOffset, kPose)));
    CHECK((sameBits(joint.lower, -kThird) && joint.upper == std::numeric_limits<double>::infinity()));
    CHECK((sameBits(joint.start, kTiny) && sameBits(joint.speed, kThird) && sameBits(joint.damping, kTiny)));
    CHECK((sameBits(joint.friction, kLarge) && sameBits(joint.inertia, kThird)));
    CHECK(sameBits(std::get<JointForce>(joint.command.value()).value, kLarge));
    CHECK(sameBits(joint.mass.value().mass, kThird));
    CHECK_FALSE(back.joints[1].command.has_value());
}

} // namespace replay_articulation_test
