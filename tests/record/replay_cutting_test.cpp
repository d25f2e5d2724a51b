#include "effort.h"
#include "engine/meshes.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "record/round_trip.h"

namespace replay_cutting_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::record_test;

namespace {

SoftBodyDef tissue(double y, double threshold)
{
    SoftBodyDef def{.mesh = shared(boxMesh({6, 4, 4}, {0.06, 0.04, 0.04}, 0.2)),
                    .material = FemMaterial{.youngModulus = 5e3, .tearingThreshold = threshold},
                    .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
                    .collision = {{}},
                    .dynamicTopology = true};
    def.pose.position = {0, y, 0};
    return def;
}

RigidBodyDef scalpel()
{
    auto mesh = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, -0.03, 0}, {0, 0.03, 0}, {0, 0.03, 0.05}, {0, -0.03, 0.05}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    return {.elements = {Pose{.position = {0.0312, 0.02, 0.06}}},
            .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}};
}

/// One block is cut through, another is pulled until it tears, and a ball held by a hand presses it meanwhile.
template <class AfterStep> void run(PhysicsServer& server, AfterStep&& afterStep)
{
    server.keepLog(true);
    server.hashEveryStep(true);
    server.setGravity({0, 0, -9.81});
    server.add(tissue(0.0, kNever));
    const BodyId pulled = server.add(tissue(0.1, 900.0));
    const BodyId blade = server.add(scalpel());
    RigidBodyDef ball{.name = "ball", .elements = {Pose{.position = {0.02, 0.12, 0.05}}}};
    ball.collision = {{}};
    ball.mesh = geometry::shapes::sphere(0.008, 4);
    ball.dynamic = true;
    const BodyId held = server.add(ball);
    for (int step = 0; step < 150; ++step) {
        server.setPose(blade, {{0.0312, 0.02, 0.06 - 5e-4 * step}, {}});
        std::vector<NodalForce> pull;
        for (int node = 150; node < 175; ++node) pull.push_back({.node = node, .force = {0.0015 * step, 0, 0}});
        if (step < 100) server.setForces(pulled, pull);
        if (step == 100) server.setForces(pulled, {});
        server.setHaptic(held, {.pose = {.position = {0.02, 0.12, 0.05 - 5e-4 * step}, .orientation = {}},
                                .velocity = {0, 0, -0.5},
                                .coupling = {.linearStiffness = 300.0, .linearDamping = 1.0}});
        server.step(1e-3);
        afterStep();
    }
}

} // namespace

TEST_CASE("a session of cutting, tearing and a hand that presses is replayed with the same hash at every step, "
          "whatever the threads")
{
    const record::ScratchFile file("cut.rec");
    int cuts = 0, tears = 0, loose = 0;
    std::size_t pushing = 0; // number of contacts
    {
        PhysicsServer server(engine::makeNativeEngine({.threads = 1}));
        record::RecordingWriter writer(file.path(), {});
        run(server, [&] {
            const StepRecord& step = *server.nextRecord();
            pushing += step.contacts.size();
            for (const Rupture& rupture : step.report.topology.ruptures) {
                (rupture.kind == Rupture::Kind::Cut ? cuts : tears) += 1;
                loose += static_cast<int>(rupture.detached.size());
            }
            writer.write(step);
            server.popRecord();
        });
    }
    CHECK(cuts > 5);
    CHECK(tears > 5);
    CHECK(loose > 0);
    CHECK(pushing > 100);
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == 150);
    for (int threads : {1, kManyThreads}) {
        CAPTURE(threads);
        CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.threads = threads})));
    }
}

TEST_CASE("a body's parameters of cutting and tearing survive a file, infinity too")
{
    for (double threshold : {kNever, kThird, 5000.0}) {
        const SoftBodyDef def = roundTrip(tissue(0.0, threshold));
        CHECK(def.dynamicTopology);
        CHECK(sameBits(std::get<FemMaterial>(def.material).tearingThreshold, threshold));
        CHECK_FALSE(def.collision.front().cutting);
    }
    const RigidBodyDef blade = roundTrip(scalpel());
    CHECK(blade.collision.front().cutting);
    CHECK(blade.collision.front().proximity == 0.0);
}

} // namespace replay_cutting_test
