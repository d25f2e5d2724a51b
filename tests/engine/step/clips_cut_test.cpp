#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"
#include "engine/step/clip_body.h"

namespace clips_cut_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kStep = 1e-3;

/// A beam along x, 16 mm long, 4 mm high and 6 mm deep, that may be cut, and a clip on 8 mm of it.
struct Clipped {
    Stage stage;
    BodyId beam, clip, knife;
    AttachmentId hold;

    explicit Clipped(const ClipDef& def = {.width = 8e-3, .closingForce = 0.05, .stiffness = 500.0})
    {
        SoftBodyDef soft{.name = "beam",
                         .mesh = shapes::block({16e-3, 4e-3, 6e-3}, {12, 3, 5}),
                         .material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.3},
                         .rayleigh = {50.0, 0.0},
                         .gravity = false};
        soft.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-7.9e-3, 1, 1}}},
                            {.box = geometry::Box{{7.9e-3, -1, -1}, {1, 1, 1}}}};
        soft.dynamicTopology = true;
        beam = stage.add(soft);
        clip = stage.add(clipBody());
        const Quat across = axisAngle({0, 0, 1}, std::numbers::pi / 2);
        RigidBodyDef blade{.name = "knife", .elements = {{{0, 20e-3, 0}, across}}};
        blade.collision = {{.mesh = shapes::sheet(10e-3, 10e-3, {1, 1}), .cutting = true}};
        knife = stage.add(blade);
        stage.run(5, kStep);
        hold = AttachmentId{++stage.lastAttachment};
        stage.post(ApplyClip{hold, clip, beam, def});
        stage.run(400, kStep);
    }
    /// The knife goes down through the beam at x [m], and up beside it.
    StepReport cutAt(double x)
    {
        const Quat across = axisAngle({0, 0, 1}, std::numbers::pi / 2);
        StepReport all;
        // Round the beam, faster than a blade cuts, and then down.
        for (const Vec3 place : {Vec3{x, -20e-3, 0.5}, Vec3{x, 20e-3, 0.5}, Vec3{x, 20e-3, 0}}) {
            stage.post(SetPose{knife, 0, {place, across}});
            stage.step(kStep);
        }
        for (int i = 0; i <= 400; ++i) {
            stage.post(SetPose{knife, 0, {{x, 20e-3 - 1e-4 * i, 0}, across}});
            const std::uint32_t flags = all.flags;
            const int slipped = all.clips.slipped;
            all = stage.step(kStep);
            all.flags |= flags;
            all.clips.slipped += slipped;
        }
        return all;
    }
    /// [m] Where the points of the pairs are in the tissue at rest.
    std::vector<Vec3> places()
    {
        std::vector<Vec3> out;
        for (const ClipPair& pair : stage.soft().clips.at(0).pairs)
            for (const auto& side : pair) out.push_back(meanOf(side, stage.model().rest));
        return out;
    }
    /// [m] The same of the points that the rigid body hangs on, and where the middles of their pairs are.
    std::array<std::vector<Vec3>, 2> holds()
    {
        std::array<std::vector<Vec3>, 2> out;
        const Clip& each = stage.soft().clips.at(0);
        for (const Attachment& attachment : stage.world.scene().attachments) {
            if (attachment.id != hold) continue;
            for (std::size_t i = 0; i < attachment.pairs.size(); ++i) {
                const ClipPair& pair = each.pairs[each.corners[i]];
                out[0].push_back(meanOf(attachment.pairs[i][1].nodes, stage.model().rest));
                out[1].push_back(0.5 * (meanOf(pair[0], stage.model().rest) + meanOf(pair[1], stage.model().rest)));
            }
        }
        return out;
    }
};

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double most = a.size() == b.size() ? 0.0 : 1.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, distance(a[i], b[i]));
    return most;
}

} // namespace

TEST_CASE("the points of a clip keep their places in the tissue across one cut and two, and the clip holds")
{
    Clipped it;
    const std::vector<Vec3> before = it.places();
    for (const double x : {1.21e-3, -1.63e-3}) {
        const StepReport cut = it.cutAt(x);
        CHECK_FALSE(cut.has(StepFlag::Undone));
        CHECK(cut.clips.slipped == 0);
        CHECK(farthest(it.places(), before) < 1e-12);
        const auto [hangs, middles] = it.holds();
        REQUIRE(!hangs.empty());
        CHECK(farthest(hangs, middles) < 1e-12);
        CHECK(it.stage.world.scene().clipReports.at(0).gap < 4e-3);
    }
    CHECK(it.stage.model().pieces.size() == 3);
    CHECK(it.stage.run(200, kStep).flags == 0);
}

TEST_CASE("a clip that is smaller than the tissue is told, in the step, the frame and the change")
{
    for (const ClipDef& def : {ClipDef{.opening = 2.4e-3}, ClipDef{.length = 3e-3}, ClipDef{}}) {
        Clipped it;
        it.stage.post(Release{it.hold});
        it.stage.run(300, kStep);
        it.stage.post(ApplyClip{AttachmentId{77}, it.clip, it.beam, def});
        const StepReport report = it.stage.step(kStep);
        const bool taken = def.opening > 4e-3;
        const bool small = def.opening < 4e-3 || def.length < 6e-3;
        CHECK(report.clips.applied == taken);
        CHECK(report.clips.partial == (small && taken));
        REQUIRE(report.clipChanges.size() == 1);
        CHECK(report.clipChanges[0].kind == (taken ? ClipChange::Kind::Applied : ClipChange::Kind::Missed));
        CHECK(report.clipChanges[0].partial == (small && taken));
        if (taken) CHECK(it.stage.world.scene().clipReports.at(0).partial == small);
    }
}

TEST_CASE("a clip lower than a round tube takes its two sides, and is told to be too small")
{
    Stage stage;
    std::vector<Vec3> line;
    for (int i = 0; i <= 20; ++i) line.push_back({1e-3 * i - 10e-3, 0, 0});
    const BodyId tube = stage.add(SoftBodyDef{.name = "tube", .mesh = shapes::vessel(line, 1.2e-3, 0.8e-3, {12, 1})});
    RigidBodyDef body{.name = "clip", .elements = {Pose{}}, .mesh = shapes::box({1e-3, 1e-3, 8e-3}), .dynamic = true};
    body.mass = TotalMass{1e-4};
    const BodyId clip = stage.add(body);
    stage.step(kStep);
    stage.post(ApplyClip{AttachmentId{++stage.lastAttachment}, clip, tube, {.opening = 2.8e-3}});
    const StepReport report = stage.step(kStep);
    CHECK(report.clips.applied == 1);
    CHECK(report.clips.partial == 1);
}

TEST_CASE("a vessel that was clipped shut and cut beside the clip springs open when the clip is released")
{
    // The clip presses the walls through each other before the cut lets the vessel collide with itself.
    constexpr double slow = 0.01; // [s] a step
    Stage stage;
    std::vector<Vec3> line;
    for (int i = 0; i <= 8; ++i) line.push_back({5e-3 * i - 20e-3, 0, 0});
    SoftBodyDef def{.name = "artery", .mesh = shapes::vessel(line, 3e-3, 0.5e-3, {16, 1})};
    def.material = FemMaterial{.youngModulus = 50e3, .poissonRatio = 0.45};
    def.gravity = false;
    def.dynamicTopology = true;
    def.collision = {{.proximity = 2e-4}};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-19.5e-3, 1, 1}}},
                       {.box = geometry::Box{{19.5e-3, -1, -1}, {1, 1, 1}}}};
    stage.add(def);
    stage.run(2, slow);
    const std::vector<Vec3> start = stage.soft().x;
    const auto height = [&] {
        double low = 0.0, high = 0.0; // [m] nodes that were under the clip
        for (std::size_t n = 0; n < start.size(); ++n) {
            if (std::fabs(start[n].x + 8e-3) > 2.6e-3) continue;
            low = std::min(low, stage.soft().x[n].y);
            high = std::max(high, stage.soft().x[n].y);
        }
        return high - low;
    };
    const double open = height();
    const BodyId clip = stage.add(clipBody({-8e-3, 0, 0}));
    const AttachmentId hold{++stage.lastAttachment};
    stage.post(ApplyClip{hold, clip, BodyId{1}, {.length = 12e-3, .opening = 12e-3}});
    stage.run(50, slow);
    CHECK(height() < 0.4 * open);

    const Quat across = axisAngle({0, 0, 1}, std::numbers::pi / 2);
    RigidBodyDef blade{.name = "knife", .elements = {{{0.3e-3, 30e-3, 0}, across}}};
    blade.collision = {{.mesh = shapes::sheet(20e-3, 30e-3, {1, 1}), .cutting = true}};
    const BodyId knife = stage.add(blade);
    for (int i = 1; i <= 30; ++i) {
        stage.post(SetPose{knife, 0, {{0.3e-3, 30e-3 - 2e-3 * i, 0}, across}});
        stage.step(slow);
    }
    CHECK(stage.model().pieces.size() == 2);
    stage.post(Release{hold});
    stage.run(50, slow);
    CHECK(height() == Approx(open).epsilon(0.01));
    CHECK_FALSE(stage.step(slow).has(StepFlag::Intersecting));
}

TEST_CASE("walls that a clip has pressed through each other are not told as intersecting")
{
    constexpr double slow = 4e-3; // [s] a step
    Stage stage;
    std::vector<Vec3> line;
    for (int i = 0; i <= 40; ++i) line.push_back({0.75e-3 * i - 15e-3, 0, 0});
    SoftBodyDef def{.name = "duct", .mesh = shapes::vessel(line, 1e-3, 0.8e-3, {16, 2}), .gravity = false};
    def.material = FemMaterial{.youngModulus = 50e3, .poissonRatio = 0.45};
    def.collision = {{.proximity = 1.5e-4}};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-14.9e-3, 1, 1}}},
                       {.box = geometry::Box{{14.9e-3, -1, -1}, {1, 1, 1}}}};
    stage.add(def);
    const BodyId clip = stage.add(clipBody({0, 0, 0}));
    stage.step(slow);
    const AttachmentId hold{++stage.lastAttachment};
    stage.post(ApplyClip{hold, clip, BodyId{1}, {}});
    CHECK_FALSE(stage.run(300, slow).has(StepFlag::Intersecting));
}

} // namespace clips_cut_test
