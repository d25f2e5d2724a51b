#include "engine/stage.h"

#include "filasofia/engine/contact/sheathed_blades.h"
#include "filasofia/engine/rupture/elements_at.h"
#include "filasofia/geometry/shapes.h"

#include <array>
#include <cmath>
#include <random>
#include <span>

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
    int pushedOn = 0; ///< steps in which a blade that was off was pushed on

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
            const physics::TopologyReport report = stage.step(1e-3).topology;
            ruptures += report.ruptures.size();
            pushedOn += report.bladeOff;
            stage.world.capture(frame);
            for (const frame::Contact& contact : frame.contacts)
                if (contact.first != contact.second) force = std::max(force, contact.normalForce);
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

TEST_CASE("a blade that is switched off in tissue stays in its cut without a force until it is out")
{
    Hook hook;
    hook.move(0.033, 0.020);
    hook.cutting(false);
    const std::size_t before = hook.ruptures;
    CHECK(before > 0);
    hook.move(0.020, 0.020);
    CHECK(hook.pushedOn == 0);
    hook.move(0.020, 0.033); // contact with the walls of the cut gave kilonewtons here
    CHECK(hook.force == 0.0);
    CHECK(hook.pushedOn == 0);
    CHECK(hook.stage.world.scene().rigid[0].state.sheath == 0);
    hook.move(0.033, 0.027); // beside its cut, which is closed, it pushes again
    CHECK(hook.force > 0.05);
    CHECK(hook.force < 5.0);
    CHECK(hook.ruptures == before);
}

TEST_CASE("a blade that is off and pushed on into tissue is counted, and cuts when it is switched on again")
{
    Hook hook;
    hook.move(0.033, 0.020);
    hook.cutting(false);
    const std::size_t before = hook.ruptures;
    hook.move(0.020, 0.014); // one row of elements
    CHECK(hook.pushedOn > 0);
    CHECK(hook.ruptures == before);
    CHECK(hook.force == 0.0);
    hook.move(0.014, 0.020);
    hook.cutting(true);
    hook.move(0.020, 0.004);
    CHECK(hook.ruptures > before);
}

TEST_CASE("a triangle is near an element if no plane parts them by more than the margin")
{
    // Against the distance of points of both, taken at random.
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-1.0, 1.0), share(0.0, 1.0);
    const auto point = [&] { return Vec3{coordinate(random), coordinate(random), coordinate(random)}; };
    const auto inside = [&](std::span<const Vec3> of) {
        Vec3 sum;
        double all = 0.0;
        for (const Vec3& each : of) {
            const double weight = -std::log(share(random) + 1e-12);
            sum += weight * each;
            all += weight;
        }
        return 1.0 / all * sum;
    };
    int near = 0, apart = 0;
    for (int turn = 0; turn < 200; ++turn) {
        const std::array<Vec3, 3> triangle{point(), point(), point()};
        const Vec3 aside{turn % 2 == 0 ? 1.5 : 0.0, 0.0, 0.0};
        const std::array<Vec3, 4> corners{aside + point(), aside + point(), aside + point(), aside + point()};
        const std::span<const Vec3> element(corners.data(), turn % 3 == 0 ? 3 : 4);
        double least = 1e9;
        for (int i = 0; i < 2000; ++i) least = std::min(least, distance(inside(triangle), inside(element)));
        const bool said = isNear(triangle, element, 0.1);
        near += said;
        apart += !said;
        if (!said) CHECK(least > 0.1);      // never apart if points are near
        if (least > 0.6) CHECK_FALSE(said); // and never near if all points are far
    }
    CHECK(near > 20);
    CHECK(apart > 20);
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
