#include "engine/contact/attachment_scene.h"
#include "filasofia/frame/attachment.h"

namespace dissection_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::AttachmentDef;

namespace {

constexpr double kDt = 1e-3; // [s]
const AttachmentId kLayer{2};

/// A strip of 60 mm on a bed whose lower side is held, tied to it by springs under its whole length, and a hand at one
/// end of the strip.
struct Strip {
    Stage stage{{.period = kDt, .threads = 1}};
    BodyId bed, strip, hand;
    double lifted = 0.0;
    int parted = 0, told = 0; ///< points that let go: by the frames, and by the steps' reports
    bool broken = false;

    explicit Strip(const AttachmentDef& layer)
    {
        bed = stage.add(physics::SoftBodyDef{.name = "bed",
                                             .mesh = geometry::shapes::block({0.06, 0.01, 0.01}, {12, 2, 2}),
                                             .pose = {{0, -0.005, 0}, {}},
                                             .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0099, 1}}}},
                                             .dynamicTopology = true});
        strip = stage.add(physics::SoftBodyDef{.name = "strip",
                                               .mesh = geometry::shapes::block({0.06, 0.004, 0.01}, {12, 1, 2}),
                                               .pose = {{0, 0.002, 0}, {}},
                                               .attachments = {layer}});
        hand = stage.add(physics::RigidBodyDef{.name = "hand", .elements = {{{0.03, 0.004, 0}, {}}}});
        stage.post(physics::Attach{{3}, strip, {.box = geometry::Box{{0.0299, -1, -1}, {1, 1, 1}}, .to = hand}});
        stage.lastAttachment = 3;
        step();
    }
    physics::StepReport step()
    {
        stage.post(physics::SetPose{hand, 0, {{0.03, 0.004 + lifted, 0}, {}}});
        const physics::StepReport report = stage.step(kDt);
        for (const physics::AttachmentBreak& each : report.breaks)
            if (each.id == kLayer) told += each.points;
        for (const frame::Attachment& each : reports())
            if (each.id == kLayer) {
                parted += each.parted;
                broken = broken || each.broken;
            }
        return report;
    }
    const std::vector<frame::Attachment>& reports() { return stage.world.scene().attachmentReports; }
    std::size_t points()
    {
        for (const Attachment& each : stage.world.scene().attachments)
            if (each.id == kLayer) return each.pairs.size();
        return 0;
    }
};

AttachmentDef layer()
{
    return {.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}, .stiffness = 100.0, .to = BodyId{1}};
}

} // namespace

TEST_CASE("a strip that is drawn off its bed lets go point by point, at the force that a point bears")
{
    AttachmentDef tie = layer();
    tie.pointBreakForce = 0.02;
    Strip scene(tie);
    REQUIRE(scene.points() == 39); // 13 rows of three nodes
    CHECK(frame::connected(scene.strip, scene.bed, scene.reports()));
    std::size_t before = 39, fewest = 39, most = 0;
    double largest = 0.0; // [m] that a spring was drawn out at the start of a step in which it held
    for (int i = 0; i < 3000 && !scene.broken; ++i) {
        scene.lifted = std::min(0.06, i * 2e-5);
        scene.step();
        most = std::max(most, before - scene.points());
        before = scene.points();
        fewest = std::min(fewest, before);
        for (const Attachment& each : scene.stage.world.scene().attachments)
            for (const auto& pair : each.pairs)
                if (each.id == kLayer)
                    largest = std::max(largest, distance(meanOf(pair[0].nodes, scene.stage.soft(1).x),
                                                         meanOf(pair[1].nodes, scene.stage.soft(0).x)));
    }
    CHECK(scene.parted == 39);
    CHECK(scene.told == 39);
    CHECK(scene.broken);
    CHECK(scene.points() == 0);
    CHECK(most <= 9); // row by row, not all at once
    CHECK(largest * 100.0 <= 1.02 * tie.pointBreakForce);
    CHECK(largest * 100.0 >= 0.9 * tie.pointBreakForce);
    CHECK_FALSE(frame::connected(scene.strip, scene.bed, scene.reports()));
    CHECK(scene.stage.world.scene().attachmentForces.size() == scene.stage.world.scene().attachments.size());
}

TEST_CASE("a blade parts the points that its path comes near to, and no others")
{
    for (const bool cuttable : {true, false}) {
        AttachmentDef tie = layer();
        tie.cutDistance = cuttable ? 0.002 : 0.0;
        Strip scene(tie);
        const BodyId blade = scene.stage.add(physics::RigidBodyDef{
            .name = "blade",
            .elements = {{{0.021, 0.0, -0.02}, {}}},
            .collision = {
                {.mesh = std::make_shared<const geometry::TriangleMesh>(geometry::TriangleMesh{
                     .vertices = {{-0.004, 0, 0}, {0.02, 0, 0}, {0.02, 0, -0.03}}, .triangles = {{0, 1, 2}}, .uv = {}}),
                 .proximity = 0.0,
                 .cutting = true}}});
        for (int i = 0; i < 60; ++i) {
            scene.stage.post(physics::SetPose{blade, 0, {{0.021, 0.0, -0.02 + i * 5e-4}, {}}});
            scene.step();
        }
        // The blade reaches from x = 17 mm outwards: the rows at 20, 25 and 30 mm, but not the one at 15 mm.
        CHECK(scene.points() == (cuttable ? 30 : 39));
        CHECK(scene.parted == (cuttable ? 9 : 0));
        CHECK(frame::connected(scene.strip, scene.bed, scene.reports()));
    }
}

TEST_CASE("points that have let go hold again after a reset")
{
    AttachmentDef tie = layer();
    tie.pointBreakForce = 0.02;
    Strip scene(tie);
    for (int i = 0; i < 400; ++i) {
        scene.lifted = i * 2e-5;
        scene.step();
    }
    CHECK(scene.points() < 39);
    CHECK(scene.points() > 0);
    scene.lifted = 0.0;
    scene.stage.post(physics::Reset{});
    scene.step();
    CHECK(scene.points() == 39);
    Strip fresh(tie);
    fresh.step();
    scene.step();
    CHECK(scene.stage.soft(1).x == fresh.stage.soft(1).x);
}

TEST_CASE("bodies are connected through other bodies, not through space, and not by what has broken")
{
    const BodyId a{1}, b{2}, c{3}, d{4};
    std::vector<frame::Attachment> all{
        {.id = {1}, .body = a, .to = b}, {.id = {2}, .body = c, .to = b}, {.id = {3}, .body = d}};
    CHECK(frame::connected(a, c, all));
    CHECK(frame::connected(d, d, all));
    CHECK_FALSE(frame::connected(a, d, all));
    all[1].broken = true;
    CHECK_FALSE(frame::connected(a, c, all));
}

} // namespace dissection_test
