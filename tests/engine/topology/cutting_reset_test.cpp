#include "engine/stage.h"

namespace cutting_reset_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A slab of tissue that has sunk by 5 mm, and a blade that was added 2 mm above it: 3 mm deep in the slab at rest.
struct SunkSlab {
    Stage stage;
    std::vector<Vec3> rest;

    SunkSlab()
    {
        stage.add(SoftBodyDef{.mesh = shared(boxMesh({10, 8, 6}, {0.05, 0.04, 0.03}, 0.2)),
                              .material = FemMaterial{.youngModulus = 5e3},
                              .gravity = false,
                              .dynamicTopology = true});
        stage.step(0.0);
        for (Vec3& x : stage.soft().x) x.z -= 5e-3;
        const TriangleMeshSource blade = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, -0.1, 0}, {0, 0.1, 0}, {0, 0.1, 0.1}, {0, -0.1, 0.1}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        stage.add(RigidBodyDef{.elements = {Pose{.position = {0.0262, 0.02, 0.027}}},
                               .collision = {{.mesh = blade, .proximity = 0, .cutting = true}}});
        stage.run(3, 1e-3);
        rest = stage.model().rest;
    }
    /// A cut would slide nodes or create new ones.
    [[nodiscard]] bool isWhole() { return stage.model().rest == rest; }
};

} // namespace

TEST_CASE("a reset that moves tissue back onto a blade cuts nothing")
{
    SunkSlab slab;
    slab.stage.post(Reset{});
    slab.stage.run(3, 1e-3);
    CHECK(distance(slab.stage.soft().x[0], slab.stage.model().rest[0]) < 1e-6); // it is back
    CHECK(slab.isWhole());
}

TEST_CASE("a tune that moves tissue over a blade cuts nothing, and tissue that moves over it by itself is cut")
{
    for (const bool tuned : {true, false}) {
        SunkSlab slab;
        if (tuned) {
            slab.stage.post(Tune{[](PhysicsEngine& engine) {
                for (Vec3& x : dynamic_cast<World&>(engine).scene().soft[0].state.x) x.z += 5e-3;
            }});
            slab.stage.run(3, 1e-3);
        } else {
            for (Vec3& v : slab.stage.soft().v) v.z = 0.5;
            slab.stage.run(10, 1e-3);
        }
        CHECK(slab.isWhole() == tuned);
    }
}

} // namespace cutting_reset_test
