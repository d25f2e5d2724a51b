#include "engine/meshes.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "record/runs.h"

namespace replay_attachments_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

SoftBodyDef block(double x)
{
    SoftBodyDef def{.mesh = shared(boxMesh({3, 3, 3}, {0.03, 0.03, 0.03})), .collision = {{}}};
    def.pose.position = {x, 0.0004, 0};
    return def;
}

RigidBodyDef box(Vec3 half, Vec3 at, bool dynamic)
{
    RigidBodyDef def{.elements = {Pose{at, {}}}, .mesh = geometry::shapes::box(2.0 * half), .collision = {{}}};
    def.dynamic = dynamic;
    return def;
}

/// Two blocks on a floor, one attached to the other and to a box; a tool grasps one, lifts it, and releases it.
template <class AfterStep> void run(PhysicsServer& server, AfterStep&& afterStep)
{
    server.keepLog(true);
    server.hashEveryStep(true);
    server.add(box({0.2, 0.01, 0.2}, {0, -0.01, 0}, false));
    const BodyId first = server.add(block(0.0));
    SoftBodyDef tied = block(0.03);
    tied.attachments = {{.within = 1e-4, .to = first}, {.nodes = {63}, .stiffness = 30.0}};
    const BodyId second = server.add(tied);
    const BodyId weight = server.add(box({0.005, 0.005, 0.005}, {0.07, 0.0055, 0.01}, true));
    const BodyId tool = server.add(box({0.01, 0.005, 0.01}, {0.0152, 0.0357, 0.0149}, false));
    const AttachmentId rope = server.attach(weight, {.points = {{-0.005, 0, 0}}, .stiffness = 20.0, .to = second});
    AttachmentId grip;
    for (int step = 0; step < 120; ++step) {
        server.setPose(tool, {{0.0152, step < 30 ? 0.0357 - 2e-5 * step : 0.0351 + 1e-4 * (step - 30), 0.0149}, {}});
        if (step == 30) grip = server.grasp(tool, first);
        if (step == 40) server.attach(first, AttachmentDef{.ball = Ball{{0, 0.03, 0}, 0.011}, .breakForce = 0.05});
        if (step == 80) server.release(grip);
        if (step == 90) server.release(server.attachments(second)[1]);
        if (step == 95) server.release(rope);
        if (step == 100) server.reset();
        if (step == 110) server.remove(first);
        server.step(1e-3);
        afterStep(step);
    }
}

} // namespace

TEST_CASE("contacts, attachments, grasps and releases are replayed with the same hash at every step")
{
    const record::ScratchFile file("attached.rec");
    int most = 0, broken = 0, pushing = 0;
    {
        PhysicsServer server(engine::makeNativeEngine());
        record::RecordingWriter writer(file.path(), {});
        run(server, [&](int) {
            const StepRecord& step = *server.nextRecord();
            CHECK_FALSE(step.report.has(StepFlag::NothingAttached));
            most = std::max(most, static_cast<int>(step.attachments.size()));
            for (const frame::Attachment& each : step.attachments) broken += each.broken ? 1 : 0;
            pushing = std::max(pushing, step.report.contacts.active);
            CHECK(server.latest()->attachments.size() == step.attachments.size());
            writer.write(step);
            server.popRecord();
        });
    }
    CHECK(most == 5);
    CHECK(broken == 1);
    CHECK(pushing > 10);
    const record::Recording recording = record::readRecording(file.path());
    CHECK(recording.steps.size() == 120);
    CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.threads = 2})));
}

} // namespace replay_attachments_test
