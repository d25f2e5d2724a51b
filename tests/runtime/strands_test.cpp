#include "shown_stage.h"

#include "filasofia/core/error.h"
#include "filasofia/runtime/strands.h"

#include <set>

namespace strands_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A block on a bed that is held, with a layer between them, and a box by which the block can be lifted.
struct Layer {
    ShownStage stage;
    BodyId bed, block, hand;

    explicit Layer(double pointBreakForce = 0.02, double cutDistance = 0.0)
    {
        physics::SoftBodyDef def{.name = "bed", .mesh = ShownStage::mesh()};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0299, 1}}}};
        bed = stage.physics.add(def);
        def.name = "block";
        def.pose.position.y = 0.06;
        def.attachments = {{.within = 1e-3,
                            .stiffness = 20.0,
                            .to = bed,
                            .pointBreakForce = pointBreakForce,
                            .cutDistance = cutDistance}};
        block = stage.physics.add(def);
        hand = stage.addBox({Pose{{0, 0.11, 0}, {}}});
        stage.step();
        stage.physics.attach(block, {.box = geometry::Box{{-1, 0.089, -1}, {1, 1, 1}}, .to = hand});
    }
    void lift(double height)
    {
        stage.physics.setPose(hand, {{0, 0.11 + height, 0}, {}});
        stage.step();
    }
    const visual::VisualBody& drawn() { return *stage.visual.bodies().at(0); }
};

} // namespace

TEST_CASE("the points of a layer are drawn as strands between both organs, until they let go")
{
    Layer layer;
    layer.stage.bindings.show(layer.block, {.strands = StrandsDef{.radius = 0.1e-3, .perPoint = 2, .spread = 0.5e-3}},
                              layer.stage.physics);
    layer.lift(0.0);
    const std::size_t points = layer.stage.physics.latest()->attachedPoints.size();
    REQUIRE(points == 15); // 3 x 5 nodes
    CHECK(layer.drawn().vertices().size() == points * 2 * 20);
    for (int i = 1; i <= 20; ++i) layer.lift(2e-5 * i);
    CHECK(layer.drawn().visible());
    for (const frame::AttachedPoint& each : layer.stage.physics.latest()->attachedPoints) {
        CHECK(each.place.y > each.toPlace.y);
        int near[2] = {0, 0}; // corners of strands at either end
        for (const Vec3& x : layer.drawn().vertices()) {
            near[0] += distance(x, each.place) < 1e-3;
            near[1] += distance(x, each.toPlace) < 1e-3;
        }
        CHECK(near[0] >= 8); // two strands of four sides
        CHECK(near[1] >= 8);
    }
    int held = 15;
    for (int i = 1; i <= 400 && held > 0; ++i) {
        layer.lift(4e-4 + 2e-5 * i);
        const int now = static_cast<int>(layer.stage.physics.latest()->attachedPoints.size());
        CHECK(now <= held);
        std::set<std::array<double, 3>> places;
        for (const Vec3& x : layer.drawn().vertices()) places.insert({x.x, x.y, x.z});
        if (now > 0) CHECK(static_cast<int>(places.size()) <= now * 2 * 20);
        held = now;
    }
    CHECK(held == 0);
    CHECK_FALSE(layer.drawn().visible());
}

TEST_CASE("the strands of a point stay beside each other when other points let go")
{
    std::vector<frame::AttachedPoint> points;
    for (int i = 0; i < 5; ++i) points.push_back({AttachmentId{7}, i, {0.01 * i, 0.02, 0}, {0.01 * i, 0.0, 0.001 * i}});
    std::vector<Vec3> all, rest;
    CHECK(writeStrands(points, AttachmentId{7}, {}, all) == 15);
    points.erase(points.begin() + 1);
    CHECK(writeStrands(points, AttachmentId{7}, {}, rest) == 12);
    const auto each = static_cast<std::ptrdiff_t>(all.size() / 5);
    all.erase(all.begin() + each, all.begin() + 2 * each);
    CHECK(all == rest);
    CHECK(writeStrands(points, AttachmentId{8}, {}, rest) == 0);
    CHECK(strandMesh(12, {}).vertices.size() == rest.size());
}

TEST_CASE("strands are refused where there are none")
{
    Layer layer(physics::kNever, 0.0);
    const auto show = [&](BodyId id, const ShowDef& def) { layer.stage.bindings.show(id, def, layer.stage.physics); };
    CHECK_THROWS_WITH(show(layer.hand, {.strands = StrandsDef{}}), "show rigid body 'box': strands need a soft body");
    CHECK_THROWS_WITH(show(layer.block, {.strands = StrandsDef{.attachment = 1}}),
                      "show soft body 'block': strands.attachment must be in [0, 1), got 1");
    CHECK_THROWS_WITH(show(layer.block, {.strands = StrandsDef{}}),
                      Catch::Contains("attachments[0] has neither pointBreakForce nor cutDistance"));
    CHECK_THROWS_WITH(show(layer.block, {.strands = StrandsDef{.radius = 0.0}}),
                      Catch::Contains("strands.radius must be > 0"));
    CHECK_THROWS_WITH(
        show(layer.block, {.surface = geometry::shapes::box({0.01, 0.01, 0.01}), .strands = StrandsDef{}}),
        Catch::Contains("surface must be empty if strands are given"));
}

} // namespace strands_test
