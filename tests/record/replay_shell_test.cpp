#include "filasofia/record/replay.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/record/recording.h"
#include "record/runs.h"

namespace replay_shell_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("a session with a shell that is touched, attached and changed is replayed with the same hash at every step")
{
    const record::ScratchFile file("shell.rec");
    {
        PhysicsServer server(engine::makeNativeEngine());
        server.keepLog(true);
        server.hashEveryStep(true);
        server.setGravity({0, -9.81, 0});
        record::RecordingWriter writer(file.path(), {});
        const BodyId sheet = server.add(SoftBodyDef{.mesh = geometry::shapes::sheet(0.1, 0.1, {8, 8}),
                                                    .pose = {{0, 0.031, 0}, {}},
                                                    .material = ShellMaterial{.thickness = 0.5e-3},
                                                    .collision = {{}}});
        const BodyId ball = server.add(RigidBodyDef{.mesh = geometry::shapes::sphere(0.03, 4), .collision = {{}}});
        bool touched = false;
        for (int step = 0; step < 60; ++step) {
            if (step == 20) server.attach(sheet, {.nodes = {40}, .to = ball});
            if (step == 30) server.setMaterial(sheet, ShellMaterial{.youngModulus = 50e3, .thickness = 0.5e-3});
            if (step > 20) server.setPose(ball, {{0, 1e-4 * step, 0}, {}});
            server.step(5e-3);
            touched = touched || server.nextRecord()->report.contacts.active > 0;
            writer.write(*server.nextRecord());
            server.popRecord();
        }
        CHECK(touched);
        CHECK(server.latest()->softBody(sheet)->positions[0].y < 0.03);
    }
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == 60);
    for (const StepRecord& step : recording.steps) CHECK(step.hash != 0);
    CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.period = recording.header.period})));
}

} // namespace replay_shell_test
