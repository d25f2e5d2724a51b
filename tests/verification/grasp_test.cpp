#include "verification/attached.h"

namespace grasp_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("a grasped body is lifted, and lost if it pulls with more than the break force")
{
    const double dt = 1e-3;
    for (const bool anchored : {false, true}) {
        Stage stage = withGravity();
        physics::SoftBodyDef block{.name = "block", .mesh = shared(boxMesh({4, 4, 4}, {0.04, 0.04, 0.04}))};
        block.collision = {{}};
        if (anchored) block.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
        stage.add(block);
        physics::RigidBodyDef floor = rigidBox("floor", {0.2, 0.01, 0.2}, {0, -0.0105, 0}, false);
        floor.collision = {{}};
        stage.add(floor);
        physics::RigidBodyDef tool = rigidBox("tool", {0.008, 0.004, 0.011}, {0.0203, 0.0443, 0.0197}, false);
        tool.collision = {{}};
        const BodyId id = stage.add(tool);
        const AttachmentId grasp{++stage.lastAttachment};
        stage.step(dt);
        const double breakForce = 0.8;
        physics::GraspDef def;
        if (anchored) def.breakForce = breakForce;
        stage.post(physics::Grasp{grasp, id, {1}, def});
        double y = 0.0443, force = 0.0;
        bool broken = false;
        std::vector<physics::AttachmentBreak> breaks;
        for (int i = 0; i < 3000 && !broken; ++i) {
            y += dt * (anchored ? 0.01 : i < 1000 ? 0.03 : 0.0);
            stage.post(physics::SetPose{id, 0, Pose{{0.0203, y, 0.0197}, {}}});
            const physics::StepReport report = stage.step(dt);
            CHECK_FALSE(report.has(physics::StepFlag::NothingAttached));
            breaks.insert(breaks.end(), report.breaks.begin(), report.breaks.end());
            const frame::Attachment& now = attachmentOf(stage, grasp);
            broken = now.broken;
            force = length(now.force);
        }
        if (anchored) {
            CHECK(broken);
            REQUIRE(breaks.size() == 1);
            CHECK((breaks[0].id == grasp && breaks[0].grasp && breaks[0].to == id && breaks[0].force == force));
            verify("anchored block pulled by a tool: force at which the grasp broke over its break force, minus one",
                   std::abs(force / breakForce - 1.0), 0.05);
            stage.step(dt);
            for (const frame::Attachment& each : stage.world.scene().attachmentReports) CHECK(each.id != grasp);
        } else {
            CHECK(attachmentOf(stage, grasp).points > 3);
            CHECK(attachmentOf(stage, grasp).body == BodyId{1});
            const double weight = weightOf(stage, 0);
            verify("block lifted by a tool: force of the grasp over its weight, minus one",
                   length(attachmentOf(stage, grasp).force - Vec3{0, weight, 0}) / weight, 0.02);
            double low = 1.0;
            for (Vec3 p : stage.soft().x) low = std::min(low, p.y);
            CHECK(low > 0.02);
        }
    }
}

TEST_CASE("a block squeezed and grasped by two jaws is held for long without growing forces")
{
    Stage stage; // without gravity until it is grasped
    physics::SoftBodyDef block{.name = "block", .mesh = shared(boxMesh({3, 3, 3}, {0.03, 0.03, 0.03}))};
    block.collision = {{}};
    stage.add(block);
    std::vector<AttachmentId> grasps;
    const auto jawAt = [](int side, double squeeze) {
        return Vec3{side ? 0.0409 - squeeze : -0.0109 + squeeze, 0.0151, 0.0149};
    };
    for (int side : {0, 1}) {
        physics::RigidBodyDef jaw = rigidBox(text("jaw ", side), {0.01, 0.008, 0.008}, jawAt(side, 0.0), false);
        jaw.collision = {{}};
        stage.add(jaw);
    }
    for (int i = 1; i <= 200; ++i) { // a millimetre and a half from each side
        for (int side : {0, 1}) stage.post(physics::SetPose{{side + 2u}, 0, {jawAt(side, 2e-3 * i / 200), {}}});
        stage.step(1e-3);
    }
    for (std::uint32_t side : {0u, 1u}) {
        grasps.push_back({++stage.lastAttachment});
        stage.post(physics::Grasp{grasps.back(), {side + 2}, {1}, {}});
    }
    stage.post(physics::SetGravity{{0, -kG, 0}});
    std::vector<double> largest;
    for (int i = 0; i < 10000; ++i) {
        stage.step(1e-3);
        if (i % 1000 != 999) continue;
        double highest = 0.0;
        for (const auto& pairs : stage.world.scene().attachmentForces)
            for (Vec3 force : pairs) highest = std::max(highest, length(force));
        for (const frame::Contact& each : stage.world.scene().contactReports)
            highest = std::max(highest, each.normalForce);
        largest.push_back(highest);
    }
    const Vec3 sum = attachmentOf(stage, grasps[0]).force + attachmentOf(stage, grasps[1]).force +
                     frame::forceOn(BodyId{1}, stage.world.scene().contactReports);
    verify("block held by two jaws: largest force at a point after 10 s over that after 1 s, minus one",
           std::abs(largest.back() / largest.front() - 1.0), 0.05);
    verify("block held by two jaws: sum of the forces over its weight, minus one",
           length(sum - Vec3{0, weightOf(stage, 0), 0}) / weightOf(stage, 0), 0.02);
}

} // namespace grasp_test
