#include "filasofia/prefab/clip_applier.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/metric/catalog.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

namespace clip_applier_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

/// Two tubes along x, at y = 0 and y = 20 mm, and an applier that comes from +z.
struct Theatre {
    Simulation sim{runtime::SimulationDef{.physics = {.rate = 500, .gravity = {}, .threads = 1}}};
    BodyId duct = tube("duct", 0.0), artery = tube("artery", 20_mm);
    ArticulatedInstrument tool{
        sim,
        {.name = "applier", .kind = InstrumentKind::ClipApplier, .pose = at(0, 50_mm), .groups = {}, .opening = 1.0}};
    std::vector<BodyId> told;
    ClipApplier clips{
        sim, tool, {.clips = 3, .targets = {duct, artery}, .onClip = [this](BodyId id) { told.push_back(id); }}};

    BodyId tube(const char* name, double y)
    {
        physics::SoftBodyDef def{.name = name,
                                 .mesh = geometry::shapes::vessel({{-10_mm, y, 0},
                                                                   {-8_mm, y, 0},
                                                                   {-6_mm, y, 0},
                                                                   {-4_mm, y, 0},
                                                                   {-2_mm, y, 0},
                                                                   {-1_mm, y, 0},
                                                                   {0, y, 0},
                                                                   {1_mm, y, 0},
                                                                   {2_mm, y, 0},
                                                                   {4_mm, y, 0},
                                                                   {6_mm, y, 0},
                                                                   {8_mm, y, 0},
                                                                   {10_mm, y, 0}},
                                                                  1_mm, 0.7_mm, {8, 1})};
        def.material = physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-9_mm, 1, 1}}},
                           {.box = geometry::Box{{9_mm, -1, -1}, {1, 1, 1}}}};
        return sim.add(def);
    }
    /// The pivot with which the clip lies at this height, this far from the tubes.
    static Pose at(double y, double back) { return {{0, y, 9_mm + back}, {}}; }
    frame::FrameRef run(int steps)
    {
        sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
        return sim.physics().latest();
    }
    /// Closes on what is at this height, opens again and goes away.
    void shut(double y)
    {
        tool.move(at(y, 0));
        run(20);
        tool.close();
        run(300);
        tool.open();
        run(100);
        tool.move(at(y, 50_mm));
        run(20);
    }
};

} // namespace

TEST_CASE("an applier closes its clips on the tube that is between its jaws")
{
    Theatre it;
    CHECK(it.clips.left() == 3);
    it.run(20);
    it.shut(0.0);
    it.shut(20_mm);
    it.shut(60_mm); // nothing is there
    CHECK(it.clips.left() == 0);
    CHECK(it.clips.applied() == 2);
    CHECK(it.clips.missed() == 1);
    CHECK(it.told == std::vector<BodyId>{it.duct, it.artery, BodyId{}});
    it.shut(0.0); // the magazine is empty
    CHECK(it.told.size() == 3);
    const auto frame = it.sim.physics().latest();
    REQUIRE(frame->clips.size() == 2);
    CHECK(frame->clips[0].tissue == it.duct);
    CHECK(frame->clips[0].clip == it.clips.bodies()[0]);
    CHECK(frame->clips[1].tissue == it.artery);
    CHECK(frame->clips[1].closed);
    CHECK(length(frame->clips[0].place) < 0.5_mm);
    const Pose& clip = frame->rigidBody(it.clips.bodies()[0])->poses[0];
    CHECK(length(clip.position) < 1_mm); // it stays where it was closed
}

TEST_CASE("clips that are reloaded after a reset close again, in the same way")
{
    Theatre it;
    it.run(20);
    it.shut(0.0);
    const double gap = it.sim.physics().latest()->clips.at(0).gap;
    it.sim.reset();
    it.clips.reload();
    it.tool.open();
    auto frame = it.run(50);
    CHECK(frame->clips.empty());
    CHECK(it.clips.left() == 3);
    CHECK(frame->rigidBody(it.clips.bodies()[0])->poses[0].position.x > 1.0); // in the magazine
    it.shut(0.0);
    frame = it.sim.physics().latest();
    REQUIRE(frame->clips.size() == 1);
    CHECK(frame->clips[0].gap == Approx(gap).epsilon(0.05));
}

TEST_CASE("a reset alone reloads an applier, and a clip holds again")
{
    Theatre it;
    it.run(20);
    it.shut(0.0);
    CHECK(it.clips.left() == 2);
    it.sim.reset();
    it.run(5);
    CHECK(it.clips.left() == 3);
    CHECK(it.clips.applied() == 0);
    const auto frame = it.run(50);
    CHECK(frame->rigidBody(it.clips.bodies()[0])->poses[0].position.x > 1.0);
    it.shut(0.0);
    CHECK(it.clips.applied() == 1);
    CHECK(it.sim.physics().latest()->clips.size() == 1);
}

TEST_CASE("an applier counts what holds: nodes between the legs whose tissue reaches beyond are no hold")
{
    Theatre it;
    it.run(20);
    it.shut(4.5_mm); // the tube's upper wall is between the legs, the rest of it is not
    CHECK(it.sim.physics().latest()->clips.empty());
    CHECK(it.clips.missed() == 1);
    CHECK(it.clips.applied() == 0);
    CHECK(it.told == std::vector<BodyId>{BodyId{}});
}

TEST_CASE("an applier goes on without clips and targets that were removed")
{
    Theatre it;
    it.run(20);
    it.sim.physics().remove(it.clips.bodies()[0]);
    it.sim.physics().remove(it.artery);
    const auto report = [&] { return it.sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1}); };
    it.shut(0.0);
    CHECK(report().callbackProblems.empty());
    CHECK(it.clips.applied() == 1);
    CHECK(it.clips.left() == 1);
    REQUIRE(it.sim.physics().latest()->clips.size() == 1);
    CHECK(it.sim.physics().latest()->clips[0].clip == it.clips.bodies()[1]);
    it.sim.physics().remove(it.duct);
    it.shut(0.0);
    CHECK(report().callbackProblems.empty());
    CHECK(it.clips.missed() == 1);
    it.clips.reload();
    CHECK(report().callbackProblems.empty());
}

TEST_CASE("clips that are placed, lost and pulled off are measures of a session")
{
    Theatre it;
    MetricTracker tracker(it.sim, {.bodies = {{.body = it.tool.body()}}, .keep = true});
    it.run(20);
    it.shut(0.0);
    it.shut(60_mm); // nothing is there
    it.sim.physics().setWrench(it.clips.bodies()[0], {0, 0, 5.0}, {});
    CHECK(it.clips.slipped() == 0);
    it.run(200);
    CHECK(it.clips.slipped() == 1);
    tracker.close();
    const auto measured = metric::measure(tracker.session());
    const auto number = [&](std::string_view id) {
        const auto at = std::ranges::find(metric::catalog(), id, &metric::MetricInfo::id) - metric::catalog().begin();
        return measured.at(static_cast<std::size_t>(at)).value;
    };
    CHECK(number("clips_placed") == 1.0);
    CHECK(number("clips_lost") == 1.0);
    CHECK(number("clips_slipped") == 1.0);
    CHECK_FALSE(number("duct_leak")); // there is no duct
}

TEST_CASE("an applier without jaws closes when it is told to, and counts the clips that slip off")
{
    Theatre it;
    physics::RigidBodyDef rod{.name = "rod", .elements = {Theatre::at(0, 0)}};
    rod.mesh = geometry::shapes::box({1_mm, 1_mm, 1_mm});
    const BodyId body = it.sim.add(rod);
    ClipApplier clips(it.sim, body, {.clip = {.friction = 0.01}, .clips = 2, .targets = {it.duct}});
    CHECK_THROWS_WITH(clips.close(), "clip applier: close() needs a step before it");
    it.run(20);
    clips.close();
    it.run(300);
    CHECK(clips.applied() == 1);
    CHECK(clips.left() == 1);
    CHECK(clips.slipped() == 0);
    it.sim.physics().setWrench(clips.bodies()[0], {0, 0, 0.5}, {});
    it.run(300);
    CHECK(clips.slipped() == 1);
    CHECK(clips.applied() == 1);
    it.sim.physics().setPose(body, {{0, 0.3, 0}, {}});
    it.run(2);
    clips.close();
    clips.close(); // the magazine is empty
    it.run(5);
    CHECK(clips.missed() == 1);
    CHECK(clips.left() == 0);
    CHECK_THROWS_WITH(ClipApplier(it.sim, it.duct, {.targets = {it.duct}}),
                      "clip applier 'duct': the tool must be a rigid body, got soft body 'duct'");
}

TEST_CASE("two clips that are closed before the same step both count")
{
    Theatre it;
    physics::RigidBodyDef rod{.name = "rod", .elements = {Theatre::at(0, 0)}};
    rod.mesh = geometry::shapes::box({1_mm, 1_mm, 1_mm});
    const BodyId body = it.sim.add(rod);
    std::vector<BodyId> told;
    ClipApplier clips(it.sim, body,
                      {.clips = 3, .targets = {it.duct}, .onClip = [&](BodyId tissue) { told.push_back(tissue); }});
    it.run(20);
    clips.close();
    clips.close();
    it.run(5);
    CHECK(clips.left() == 1);
    CHECK(clips.applied() == 2);
    CHECK(clips.missed() == 0);
    CHECK(told == std::vector<BodyId>{it.duct, it.duct});
}

TEST_CASE("an applier without targets, or with wrong ones, is refused in one line")
{
    Theatre it;
    const auto problem = [&](const ClipApplierDef& def) -> std::string {
        try {
            const ClipApplier made(it.sim, it.tool, def);
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    CHECK(problem({}) == "clip applier 'applier': targets must name at least one soft body, got none");
    CHECK(problem({.targets = {it.tool.body()}}) ==
          "clip applier 'applier': targets must be soft bodies, got rigid body 'applier'");
    CHECK(problem({.clips = 0, .targets = {it.duct}}).starts_with("clip applier 'applier': clips must be in [1, 100]"));
    CHECK(problem({.clip = {.opening = 0.2_mm}, .targets = {it.duct}})
              .starts_with("clip applier 'applier': clip.opening must be > gap"));
    physics::SoftBodyDef exact = std::get<physics::SoftBodyDef>(*it.sim.physics().def(it.duct));
    exact.name = "exact";
    exact.solver = physics::Cholesky{};
    CHECK(problem({.targets = {it.duct, it.sim.add(exact)}}) ==
          "clip applier 'applier': targets: soft body 'exact': clips need integrator ImplicitEuler and the default "
          "solver");
    CHECK(problem({.clip = {.element = 1}, .targets = {it.duct}}) ==
          "clip applier 'applier': clip.element must be 0, got 1");
}

} // namespace clip_applier_test
