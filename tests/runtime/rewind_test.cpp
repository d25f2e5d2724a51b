#include "filasofia/runtime/rewind.h"

#include "cut_block.h"

namespace rewind_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A box that moves by 1 m/s along x, and a script that is called for every picture, on the thread that draws.
struct MovingStage {
    Simulation sim{{.physics = {.gravity = {}}, .window = {.width = 32, .height = 16}}};
    BodyId box;
    VisualServer* server = nullptr;

    MovingStage()
    {
        box = sim.add(RigidBodyDef{.name = "box", .mesh = shapes::box({10_mm, 10_mm, 10_mm})});
        sim.show(box);
        sim.everyStep([this](double time) { sim.physics().setPose(box, {{time, 0, 0}, {}}); });
        sim.dress([this](VisualServer& its) { server = &its; });
    }
    void run(const std::function<void()>& picture)
    {
        sim.show(visual::GuiDef{.name = "script", .renderCallback = picture});
        sim.run({.backend = Backend::Null, .seconds = 60});
    }
    [[nodiscard]] double drawn() const { return server->bodies().front()->worldPose().position.x; }
    [[nodiscard]] double now() { return sim.physics().latest() ? sim.physics().latest()->time : 0.0; }
};

} // namespace

TEST_CASE("a rewind draws the states of a run again, in any order, and the newest one when it is asked to")
{
    MovingStage stage;
    Rewind rewind(stage.sim);
    std::vector<double> asked, seen;
    double newest = 0.0;
    stage.run([&, picture = 0U]() mutable {
        if (asked.empty() && (rewind.states() < 6 || stage.now() < rewind.begin() + 0.5)) return;
        if (asked.empty()) {
            stage.sim.pause(true);
            asked = {rewind.begin() + 0.3, rewind.begin() + 0.1, rewind.begin() + 0.2, -5.0, 1e9};
        } else if (picture <= asked.size()) {
            seen.push_back(stage.drawn());
        } else {
            newest = stage.drawn();
            return stage.sim.finish("seen");
        }
        if (picture < asked.size())
            rewind.show(asked[picture]);
        else
            rewind.showNewest();
        ++picture;
    });
    REQUIRE(seen.size() == 5);
    for (std::size_t i = 0; i < 3; ++i) CHECK(seen[i] == Approx(asked[i]).margin(1e-6)); // between two states, too
    CHECK(seen[3] == Approx(rewind.begin()).margin(1e-6));
    CHECK(seen[4] == Approx(rewind.end()).margin(1e-6));
    CHECK(newest >= rewind.begin() + 0.5);
    CHECK_FALSE(rewind.shown().has_value());
}

TEST_CASE("a rewind keeps within its memory by keeping fewer states, and still reaches from the beginning to the end")
{
    MovingStage stage;
    const double memory = 1e4;
    Rewind rewind(stage.sim, {.rate = 1000, .memory = memory});
    double first = -1.0;
    std::size_t pictures = 0;
    stage.run([&] {
        if (rewind.states() == 1 && first < 0.0) first = rewind.begin();
        if (++pictures > 150) stage.sim.finish("enough");
    });
    CHECK(static_cast<double>(rewind.bytes()) <= memory);
    CHECK(rewind.states() > 5);
    CHECK(rewind.states() < 100); // a state takes 0.2 kB
    CHECK(rewind.begin() == first);
    CHECK(rewind.end() > 0.5 * stage.now());
}

TEST_CASE("a rewind goes back to before a cut, and forth again")
{
    CutBlock block(1, {8, 3, 6});
    block.sim.show(block.tissue);
    VisualServer* server = nullptr;
    block.sim.dress([&](VisualServer& its) { server = &its; });
    Rewind rewind(block.sim, {.rate = 100});
    const auto triangles = [&] {
        std::size_t count = 0;
        for (const visual::VisualBody* body : server->bodies()) count += body->triangles().size();
        return count;
    };
    std::size_t whole = 0, cut = 0, back = 0, forth = 0;
    block.sim.show(visual::GuiDef{.name = "script", .renderCallback = [&, step = 0]() mutable {
                                      const frame::FrameRef now = block.sim.physics().latest();
                                      if (!now) return;
                                      if (whole == 0) whole = triangles();
                                      if (step == 0 && now->time > 0.3 && triangles() > whole) {
                                          block.sim.pause(true);
                                          cut = triangles();
                                          rewind.show(0.0);
                                          step = 1;
                                      } else if (step == 1 && triangles() == whole) { // another thread makes them
                                          back = triangles();
                                          rewind.showNewest();
                                          step = 2;
                                      } else if (step == 2 && triangles() >= cut) {
                                          forth = triangles();
                                          block.sim.finish("seen");
                                      }
                                  }});
    block.sim.run({.backend = Backend::Null, .seconds = 120});
    CHECK(cut > whole);
    CHECK(back == whole);
    CHECK(forth >= cut);
}

TEST_CASE("a rewind that cannot be is refused")
{
    Simulation sim;
    CHECK_THROWS_WITH(Rewind(sim, {.rate = 0.5}), "rewind: rate must be in [1, 1000] 1/s, got 0.5");
    CHECK_THROWS_WITH(Rewind(sim, {.memory = 10}), Catch::Contains("rewind: memory must be in [10000, 1e+11] bytes"));
    {
        Rewind first(sim);
        CHECK_THROWS_WITH(Rewind(sim), "rewind: the simulation has one already");
        CHECK_THROWS_WITH(first.show(std::nan("")), Catch::Contains("rewind: show: time must be finite"));
    }
    std::string refused;
    sim.everyStep([&](double) {
        try {
            const Rewind late(sim);
        } catch (const Error& problem) {
            refused = problem.what();
        }
    });
    sim.run({.headless = true, .steps = 1});
    CHECK(refused == "rewind: it must be made before a run, but one is going on");
    const Rewind again(sim); // the first one is gone
    CHECK(again.states() == 0);
}

} // namespace rewind_test
