#include "filasofia/record/replay.h"

#include "effort.h"
#include "engine/sheets.h"
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

TEST_CASE("a session in which a shell is cut, torn and pressed is replayed with the same hash, whatever the threads")
{
    const record::ScratchFile file("cut_shell.rec");
    int cuts = 0, tears = 0, loose = 0;
    std::size_t touching = 0; // number of contacts
    {
        PhysicsServer server(engine::makeNativeEngine({.threads = 1}));
        server.keepLog(true);
        server.hashEveryStep(true);
        server.setGravity({0, -9.81, 0});
        record::RecordingWriter writer(file.path(), {});
        SoftBodyDef def{.mesh = geometry::shapes::sheet(0.06, 0.06, {20, 20}),
                        .material = ShellMaterial{.youngModulus = 20e3, .thickness = 1e-3},
                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -0.0299}}}},
                        .collision = {{.self = true}},
                        .dynamicTopology = true};
        const BodyId sheet = server.add(def);
        def.pose.position = {0.2, 0, 0};
        std::get<ShellMaterial>(def.material).tearingThreshold = 3e3;
        const BodyId pulled = server.add(def);
        const BodyId hand = server.add(RigidBodyDef{.name = "hand"});
        server.attach(pulled, {.box = geometry::Box{{0, -1, 0.0299}, {1, 1, 1}}, .to = hand});
        const BodyId ball = server.add(RigidBodyDef{.mesh = geometry::shapes::sphere(0.01, 4), .collision = {{}}});
        const BodyId blade = server.add(RigidBodyDef{
            .collision = {
                {.mesh = shared(
                     {.vertices = {{0, -0.02, 0}, {0, 0.02, 0}, {0, 0.02, -0.03}}, .triangles = {{0, 1, 2}}, .uv = {}}),
                 .cutting = true}}});
        for (int step = 0; step < 200; ++step) {
            server.setPose(blade, {{0.0041, 0, 0.04 - 4e-4 * step}, {}});
            server.setPose(ball, {{-0.012, -0.012 + 5e-5 * step, 0.0}, {}});
            server.setPose(hand, {{0, 0, 1e-4 * step}, {}});
            server.step(1e-3);
            const StepRecord& record = *server.nextRecord();
            touching += record.contacts.size();
            for (const Rupture& rupture : record.report.topology.ruptures) {
                (rupture.kind == Rupture::Kind::Cut ? cuts : tears) += 1;
                loose += static_cast<int>(rupture.detached.size());
            }
            writer.write(record);
            server.popRecord();
        }
        CHECK(server.latest()->softBody(sheet)->boundary->revision > 10);
    }
    CHECK(cuts > 10);
    CHECK(tears > 10);
    CHECK(loose > 1);
    CHECK(touching > 100);
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == 200);
    for (int threads : {1, kManyThreads}) {
        CAPTURE(threads);
        CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.threads = threads})));
    }
}

} // namespace replay_shell_test
