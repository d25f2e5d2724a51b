#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace severed_piece_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::StepFlag;

// What a cut has parted meets the rest of its body.
namespace {

/// A cube of 20 mm that stands on its pinned lower side, and a level blade that has gone through it at 11 mm.
struct Severed {
    Stage stage{{.period = 1e-3, .threads = 1}};
    BodyId organ;
    bool flagged = false;
    std::vector<std::size_t> end; ///< nodes at the top of the side on the left

    /// `depth` [m]: how far the blade goes, from the side on the left; the organ is 20 mm wide.
    explicit Severed(const physics::CollisionDef& collision, double depth = 0.036, double youngModulus = 20e3,
                     const std::vector<physics::CollisionDef>& others = {})
    {
        std::vector<physics::CollisionDef> models{collision};
        models.insert(models.end(), others.begin(), others.end());
        stage.world.scene().gravity = {0, -9.81, 0};
        organ = stage.add(physics::SoftBodyDef{.name = "organ",
                                               .mesh = geometry::shapes::block({0.02, 0.02, 0.02}, {5, 5, 5}),
                                               .pose = {{0, 0.01, 0}, {}},
                                               .material = physics::FemMaterial{.youngModulus = youngModulus},
                                               .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-4, 1}}}},
                                               .collision = models,
                                               .friction = 0.3,
                                               .dynamicTopology = true});
        const auto mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, 0, -0.03}, {0, 0, 0.03}, {-0.06, 0, 0.03}, {-0.06, 0, -0.03}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        const auto at = [](double x) { return Pose{{x, 0.011, 0}, {}}; };
        const BodyId blade = stage.add(physics::RigidBodyDef{
            .name = "blade", .elements = {at(-0.02)}, .collision = {{.mesh = mesh, .cutting = true}}});
        stage.step(1e-3);
        for (std::size_t i = 0; i < stage.soft().x.size(); ++i)
            if (const Vec3 x = stage.soft().x[i]; x.x < -0.0099 && x.y > 0.0195) end.push_back(i);
        for (int i = 1; i <= 300; ++i) {
            stage.post(physics::SetPose{blade, 0, at(-0.02 + depth / 300 * i)});
            flagged = stage.step(1e-3).has(StepFlag::Intersecting) || flagged;
        }
        stage.post(physics::SetPose{blade, 0, at(1.0)}); // it has left
        flagged = stage.run(400, 1e-3).has(StepFlag::Intersecting) || flagged;
    }
    double height() // its top [m]
    {
        double top = 0.0;
        for (Vec3 x : stage.soft().x) top = std::max(top, x.y);
        return top;
    }
};

} // namespace

TEST_CASE("a piece that a blade has severed rests on the rest of its organ")
{
    Severed severed({});
    REQUIRE(severed.stage.model().pieces.size() == 2);
    CHECK(severed.height() > 19.3e-3);
    CHECK(!severed.flagged);
}

TEST_CASE("a flap that hangs by its root rests on its bed, if its organ collides with itself once cut")
{
    // The lips of a cut lie on each other at rest. They were left out as neighbours are: the flap sank in by 7 mm.
    for (const bool collides : {true, false}) {
        Severed flap({.selfOnceCut = collides}, 0.026, 5e3);
        REQUIRE(flap.stage.model().pieces.size() < 2);
        double sunk = 0.0; // [m] how far the flap's free end hangs
        for (const std::size_t i : flap.end) sunk = std::max(sunk, 20e-3 - flap.stage.soft().x[i].y);
        REQUIRE(!flap.end.empty());
        CAPTURE(collides, sunk);
        CHECK((collides ? sunk < 0.4e-3 : sunk > 5e-3));
        CHECK((!collides || !flap.flagged));
    }
}

TEST_CASE("a cut organ with several models of its own surface meets itself in one of them")
{
    const physics::CollisionDef forOthers{.group = 1}, thinner{.proximity = 0.2e-3, .group = 2};
    Severed one({}), three({}, 0.036, 20e3, {forOthers, thinner}),
        second({.selfOnceCut = false}, 0.036, 20e3, {forOthers});
    CHECK((three.stage.soft().x == one.stage.soft().x)); // without the brackets, a failure prints all nodes
    CHECK((second.stage.soft().x == one.stage.soft().x));
    CHECK((!three.flagged && !second.flagged));
}

TEST_CASE(
    "a severed piece sinks into an organ that does not collide with itself once cut, and steps and the log say so")
{
    Severed severed({.selfOnceCut = false});
    CHECK(severed.height() < 17e-3);
    CHECK(severed.flagged);
}

} // namespace severed_piece_test
