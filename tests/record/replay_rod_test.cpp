#include "filasofia/record/replay.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/record/recording.h"
#include "record/runs.h"

namespace replay_rod_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("a session with a rod that is touched, attached and pulled is replayed with the same hash at every step")
{
    const record::ScratchFile file("rod.rec");
    {
        PhysicsServer server(engine::makeNativeEngine());
        server.keepLog(true);
        server.hashEveryStep(true);
        server.setGravity({0, -9.81, 0});
        record::RecordingWriter writer(file.path(), {});
        const BodyId thread = server.add(RodBodyDef{.points = {{-0.05, 0.031, 0}, {0.0, 0.032, 0.01}, {0.05, 0.031, 0}},
                                                    .spacing = 2e-3,
                                                    .pose = {{0, 1e-4, 0}, {}},
                                                    .youngModulus = 1e7,
                                                    .straight = false,
                                                    .twist = 3.0,
                                                    .yieldStrain = 1e-3,
                                                    .collision = RodCollision{.proximity = 2e-4}});
        const BodyId ball = server.add(RigidBodyDef{.mesh = geometry::shapes::sphere(0.03, 4), .collision = {{}}});
        bool touched = false;
        for (int step = 0; step < 60; ++step) {
            if (step == 20) server.attach(thread, {.nodes = {25, 26}, .to = ball});
            if (step == 25) server.setCurvature(thread, {{.begin = 0.06, .curvature = {5.0, -9.0}}}, 500.0);
            if (step == 30) server.setForces(thread, {{.node = 50, .force = {0, 0, 1e-4}}});
            if (step > 20) server.setPose(ball, {{0, 1e-4 * step, 0}, axisAngle({1, 0, 0}, 0.01 * (step - 20))});
            server.step(2e-3);
            touched = touched || server.nextRecord()->report.contacts.active > 0;
            writer.write(*server.nextRecord());
            server.popRecord();
        }
        CHECK(touched);
        CHECK(server.latest()->softBody(thread)->directors.size() == 51);
    }
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == 60);
    for (const StepRecord& step : recording.steps) CHECK(step.hash != 0);
    CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.period = recording.header.period})));
}

TEST_CASE("a session in which a blade cuts a rod and tension tears it is replayed with the same hash at every step")
{
    const record::ScratchFile file("cut_rod.rec");
    {
        PhysicsServer server(engine::makeNativeEngine());
        server.keepLog(true);
        server.hashEveryStep(true);
        record::RecordingWriter writer(file.path(), {});
        const BodyId thread = server.add(RodBodyDef{.points = {{0, 0, 0}, {0.1, 0, 0}},
                                                    .spacing = 2e-3,
                                                    .attachments = {{.nodes = {0}}},
                                                    .collision = RodCollision{},
                                                    .dynamicTopology = true,
                                                    .breakForce = 0.5});
        const geometry::TriangleMesh strip{.vertices = {{0, 0, -0.02}, {0, 0, 0.02}, {0, 0.03, 0.02}, {0, 0.03, -0.02}},
                                           .triangles = {{0, 1, 2}, {0, 2, 3}},
                                           .uv = {}};
        const BodyId blade = server.add(RigidBodyDef{
            .elements = {Pose{{0.05, 0.02, 0}}},
            .collision = {
                {.mesh = std::make_shared<const geometry::TriangleMesh>(strip), .proximity = 0.0, .cutting = true}}});
        int cuts = 0, tears = 0;
        for (int step = 0; step < 60; ++step) {
            server.setPose(blade, {{0.05, 0.02 - 1e-3 * step, 0}});
            if (step > 40) server.setForces(thread, {{.node = 20, .force = {0.05 * (step - 40), 0, 0}}});
            if (step == 30) server.removePiece(thread, 1);
            server.step(1e-3);
            for (const Rupture& each : server.nextRecord()->report.topology.ruptures)
                ++(each.kind == Rupture::Kind::Cut ? cuts : tears);
            writer.write(*server.nextRecord());
            server.popRecord();
        }
        CHECK(cuts > 0);
        CHECK(tears > 0);
        CHECK(!server.latest()->softBody(thread)->cutEdges.empty());
    }
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == 60);
    CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.period = recording.header.period})));
}

} // namespace replay_rod_test
