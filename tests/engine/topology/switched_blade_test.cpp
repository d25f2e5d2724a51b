#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace switched_blade_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A block of tissue from z = 0 up to 30 mm, held at its bottom, and a blade above it with its edge downwards.
struct Hook {
    Stage stage;
    BodyId blade;
    double force = 0.0; ///< [N] highest contact force between them
    std::size_t ruptures = 0;

    Hook() : Hook(NativeEngineDef{.threads = 1}) {}
    explicit Hook(const NativeEngineDef& engine) : stage(engine)
    {
        stage.add(physics::SoftBodyDef{.mesh = shared(boxMesh({10, 8, 6}, {0.05, 0.04, 0.03})),
                                       .material = physics::FemMaterial{.youngModulus = 5e3},
                                       .gravity = false,
                                       .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}},
                                       .collision = {{}},
                                       .dynamicTopology = true});
        const geometry::TriangleMesh sheet{.vertices = {{0, -0.05, 0}, {0, 0.05, 0}, {0, 0.05, 0.03}, {0, -0.05, 0.03}},
                                           .triangles = {{0, 1, 2}, {0, 2, 3}},
                                           .uv = {}};
        blade = stage.add(physics::RigidBodyDef{
            .elements = {at(0.033)},
            .collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(sheet), .cutting = true}}});
    }
    static Pose at(double z) { return {{0.0262, 0.02, z}, {}}; }
    void move(double from, double to)
    {
        frame::Frame frame;
        for (int i = 1; i <= 60; ++i) {
            stage.post(physics::SetPose{blade, 0, at(from + (to - from) * i / 60)});
            ruptures += stage.step(1e-3).topology.ruptures.size();
            stage.world.capture(frame);
            for (const frame::Contact& contact : frame.contacts) force = std::max(force, contact.normalForce);
        }
    }
    void cutting(bool on) { stage.post(physics::SetCutting{blade, on}); }
};

} // namespace

TEST_CASE("a blade that is switched off pushes what it would cut, and cuts when it is switched on")
{
    Hook hook;
    hook.cutting(false);
    hook.move(0.033, 0.027);
    CHECK(hook.ruptures == 0);
    CHECK(hook.force > 0.05);
    hook.move(0.027, 0.033);
    hook.cutting(true);
    hook.force = 0.0;
    hook.move(0.033, 0.020);
    CHECK(hook.ruptures > 0);
    CHECK(hook.force == 0.0); // it does not push what it cuts
}

TEST_CASE("a blade that is switched off in tissue cuts no further, until it is switched on again")
{
    Hook hook;
    hook.move(0.033, 0.020);
    hook.cutting(false);
    const std::size_t before = hook.ruptures;
    CHECK(before > 0);
    hook.move(0.020, 0.016);
    CHECK(hook.ruptures == before);
    CHECK(hook.force > 0.0);
    hook.cutting(true);
    hook.move(0.016, 0.004);
    CHECK(hook.ruptures > before);
}

TEST_CASE("whether a blade cuts belongs to the state: hash, saved state and reset know it")
{
    Hook hook, other;
    other.cutting(false);
    hook.stage.step(1e-3);
    other.stage.step(1e-3);
    CHECK(hook.stage.world.hash() != other.stage.world.hash());

    const std::shared_ptr<const physics::EngineState> off = other.stage.world.save();
    other.cutting(true);
    other.stage.step(1e-3);
    CHECK(hook.stage.step(1e-3).flags == 0);
    CHECK(hook.stage.world.hash() == other.stage.world.hash());
    other.stage.world.restore(*off);
    other.stage.post(physics::Reset{}); // keeps it
    other.move(0.033, 0.027);
    CHECK(other.ruptures == 0);
    CHECK(other.force > 0.05);
}

} // namespace switched_blade_test
