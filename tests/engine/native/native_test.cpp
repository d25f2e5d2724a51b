#include "filasofia/engine/native/native.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include "engine/meshes.h"

#include <limits>

namespace native_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A server with a hanging box and a rigid body after a few steps. The log is kept, not printed.
struct Fixture {
    PhysicsServer server{makeNativeEngine()};
    BodyId soft = server.add(SoftBodyDef{.name = "box",
                                         .mesh = shared(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})),
                                         .attachments = {{.box = geometry::Box{{0, 0, 0}, {0, 1, 1}}}}});
    BodyId rigid = server.add(RigidBodyDef{});
    std::string logged;

    Fixture()
    {
        setLogSink([this](LogLevel, std::string_view line) { logged += line; });
        for (int i = 0; i < 5; ++i) server.step(0.01);
    }
    ~Fixture() { setLogSink({}); }

    std::vector<Vec3> positions() { return server.latest()->softBody(soft)->positions; }
    StepReport tuned(std::function<void(Native&)> change)
    {
        tune(server, std::move(change));
        return server.step(0.01);
    }
};

/// Compares two equal fixtures, one of them with a rejected tune: afterwards they must be identical.
void checkRolledBack(const std::function<void(Native&)>& change, const std::string& why)
{
    INFO(why);
    Fixture twin, tuned;
    setLogSink([&](LogLevel, std::string_view line) { tuned.logged += line; });
    const std::uint64_t before = tuned.server.hash();
    tuned.server.pause(true);
    const StepReport report = tuned.tuned(change);
    CHECK(report.has(StepFlag::Tuned));
    CHECK(report.has(StepFlag::TuneRejected));
    CHECK(tuned.server.hash() == before);
    CHECK_THAT(tuned.logged, Catch::Contains(why));
    tuned.server.pause(false);
    for (int i = 0; i < 10; ++i) { // the model is rolled back too
        tuned.server.step(0.01);
        twin.server.step(0.01);
        REQUIRE(tuned.server.hash() == twin.server.hash());
    }
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST_CASE_METHOD(Fixture, "tune sees the current bodies")
{
    const std::vector<Vec3> x = positions();
    int runs = 0;
    server.pause(true);
    const StepReport report = tuned([&](Native& native) {
        ++runs;
        REQUIRE(native.softBodies() == std::vector{soft});
        CHECK(native.rigidBodies() == std::vector{rigid});
        CHECK(std::ranges::equal(native.softBody(soft).positions, x));
        CHECK(native.rigidBody(rigid).poses.size() == 1);
        CHECK(native.elementCount(soft) == 72);
        CHECK(native.springCount(soft) == 0);
        CHECK_THROWS_WITH(native.softBody(rigid), Catch::Contains("there is no such soft body"));
        CHECK_THROWS_WITH(native.element(soft, 72), "tune: element must be in [0, 72), got 72");
        REQUIRE(native.scene().soft.size() == 1);
        CHECK(native.scene().soft[0].model.id == soft);
        CHECK(native.scene().rigid.size() == 1);
        CHECK(native.scene().soft[0].state.x == x);
        CHECK(native.scene().step == 5);
    });
    CHECK(runs == 1);
    CHECK(report.has(StepFlag::Tuned));
    CHECK_FALSE(report.has(StepFlag::TuneRejected));
    CHECK_FALSE(server.step(0.01).has(StepFlag::Tuned));
}

TEST_CASE("a tune that changes nothing changes no result")
{
    Fixture a, b;
    a.tuned([](Native&) {});
    b.server.step(0.01);
    CHECK(a.server.hash() == b.server.hash());
}

TEST_CASE("making one element stiffer changes the result, and most of all at that element")
{
    Fixture a, b;
    std::array<int, 4> nodes{};
    a.tuned([&](Native& native) {
        const NativeElement first = native.element(a.soft, 0);
        native.setElement(a.soft, 0, 1000 * first.youngModulus, first.poissonRatio);
        nodes = first.nodes;
    });
    b.server.step(0.01);
    for (int i = 0; i < 30; ++i) {
        a.server.step(0.01);
        b.server.step(0.01);
    }
    const std::vector<Vec3> xa = a.positions(), xb = b.positions();
    CHECK(xa != xb);
    const auto mesh =
        std::get<std::shared_ptr<const geometry::TetMesh>>(std::get<SoftBodyDef>(*a.server.def(a.soft)).mesh);
    const auto strain = [&](const std::vector<Vec3>& x) {
        double sum = 0.0;
        for (auto [i, j] : geometry::kTetrahedronEdges) {
            const int p = nodes[i], q = nodes[j];
            sum += std::abs(distance(x[p], x[q]) / distance(mesh->nodes[p], mesh->nodes[q]) - 1.0);
        }
        return sum;
    };
    CHECK(strain(xa) < 0.1 * strain(xb));
}

TEST_CASE("a solver changed by tune is used in the next solve")
{
    Fixture a;
    CHECK(a.server.step(0.01).solves[0].iterations > 1);
    CHECK(a.tuned([](Native& native) { native.softBody(native.softBodies()[0]).solver = Cholesky{}; })
              .solves[0]
              .iterations == 1);
    const StepReport capped = a.tuned([](Native& native) {
        native.scene().soft[0].model.solver = ConjugateGradient{.maxIterations = 2, .tolerance = 1e-12};
    });
    CHECK(capped.solves[0].iterations == 2);
    CHECK(capped.has(StepFlag::NotConverged));
    CHECK(a.tuned([](Native& n) { n.scene().soft[0].model.integrator = ExplicitEuler{}; }).solves[0].iterations == 0);
}

TEST_CASE("a node pinned or unpinned by tune is pinned or unpinned")
{
    Fixture a;
    const int tip = 35;
    a.tuned([&](Native& native) {
        native.scene().soft[0].model.pins.hard[tip] = true;
        native.scene().soft[0].state.v[tip] = {};
        native.scene().soft[0].state.dv[tip] = {};
    });
    const Vec3 held = a.positions()[tip];
    for (int i = 0; i < 10; ++i) a.server.step(0.01);
    CHECK(a.positions()[tip] == held);
    a.tuned([&](Native& native) { native.scene().soft[0].model.pins.hard[tip] = false; });
    for (int i = 0; i < 10; ++i) a.server.step(0.01);
    CHECK(a.positions()[tip] != held);
}

TEST_CASE("a tune that throws is rolled back completely")
{
    checkRolledBack(
        [](Native& native) {
            native.scene().soft[0].state.x[3] = {1, 1, 1};
            native.scene().soft[0].model.elements.clear();
            native.scene().time = 99;
            throw std::runtime_error("changed my mind");
        },
        "changed my mind");
    checkRolledBack(
        [](Native& native) {
            native.scene() = {};
            throw 7;
        },
        "not a std::exception");
}

TEST_CASE("a tune that leaves a number that is not finite or out of range is rolled back completely")
{
    checkRolledBack([](Native& n) { n.scene().soft[0].state.x[3].y = kNan; }, "x[3] must be finite");
    checkRolledBack([](Native& n) { n.scene().soft[0].state.v[3].y = kNan; }, "v[3] must be finite");
    checkRolledBack([](Native& n) { n.scene().soft[0].state.pressure = kNan; }, "pressure");
    checkRolledBack([](Native& n) { n.scene().soft[0].state.rotations[0].w[3] = static_cast<float>(kNan); },
                    "rotations");
    checkRolledBack([](Native& n) { n.scene().gravity.x = kNan; }, "gravity");
    checkRolledBack([](Native& n) { n.scene().time = kNan; }, "time");
    checkRolledBack([](Native& n) { n.scene().rigid[0].state.poses[0].position.x = kNan; }, "poses must be finite");
    checkRolledBack([](Native& n) { n.scene().rigid[0].state.poses[0].orientation.w = 2; }, "unit quaternion");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.masses[2] = 0.0; }, "masses must be > 0 kg, got 0");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.elements[5].poissonRatio = 0.7; },
                    "elements[5]: poissonRatio must be in [0, 0.5), got 0.7");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.elements[5].volume = -1; }, "elements[5].volume");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.elements[5].gradients[1].z = kNan; },
                    "elements[5].gradients");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.rayleigh.mass = -1; }, "rayleigh");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.solver = ConjugateGradient{.tolerance = 2}; }, "tolerance");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.springs.push_back({.nodes = {0, 1}}); }, "springs[0]");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.pins.springs.push_back({0, {}, -1}); }, "pin's stiffness");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.pins.hard[35] = true; },
                    "the node is pinned"); // in full motion
}

TEST_CASE("a tune that leaves wrong sizes or indices is rolled back completely")
{
    checkRolledBack([](Native& n) { n.scene().soft[0].state.x.pop_back(); }, "x must have 36 entries, got 35");
    checkRolledBack([](Native& n) { n.scene().soft[0].state.forces.clear(); }, "forces must have 36 entries");
    checkRolledBack([](Native& n) { n.scene().soft[0].state.rotations.pop_back(); }, "rotations must have");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.masses.pop_back(); }, "masses must have 36 entries");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.pins.hard.pop_back(); }, "pins.hard must have 36 entries");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.elements[0].nodes[2] = 36; }, "[0, 36), got 36");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.surface[0][1] = -1; }, "[0, 36), got -1");
    checkRolledBack([](Native& n) { n.scene().soft.clear(); }, "bodies, their ids");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.id = BodyId{77}; }, "bodies, their ids");
    checkRolledBack([](Native& n) { n.scene().soft[0].model.rest.pop_back(); }, "bodies, their ids, nodes");
    checkRolledBack([](Native& n) { n.scene().rigid[0].model.rest.push_back({}); }, "bodies, their ids, nodes");
}

TEST_CASE("commands around a rejected tune are still carried out")
{
    Fixture a;
    a.server.setGravity({1, 0, 0});
    tune(a.server, [](Native& n) { n.scene().soft[0].state.x.clear(); });
    a.server.setPressure(a.soft, 5);
    a.server.step(0.01);
    CHECK_FALSE(a.tuned([](Native& n) {
                     CHECK(n.scene().gravity == Vec3{1, 0, 0});
                     CHECK(n.scene().soft[0].state.pressure == 5);
                 }).has(StepFlag::TuneRejected));
}

namespace {

/// Another engine, which only runs its commands.
struct OtherEngine final : PhysicsEngine {
    EngineInfo info() const override { return {.name = "other"}; }
    std::unique_ptr<BuiltBody> build(const BodyDef&) const override { return nullptr; }
    StepReport step(const StepInput& in) override
    {
        for (Command& command : in.commands)
            if (auto* change = std::get_if<Tune>(&command)) change->change(*this);
        return {};
    }
    void capture(frame::Frame&) const override {}
    void record(StepRecord&) const override {}
    std::uint64_t hash() const override { return 0; }
    std::shared_ptr<const EngineState> save() const override { return nullptr; }
    void restore(const EngineState&) override {}
};

} // namespace

TEST_CASE("tune on another engine is an error")
{
    PhysicsServer server(std::make_unique<OtherEngine>());
    CHECK_THROWS_WITH(tune(server, [](Native&) {}), "tune: the native engine is not in use");
    CHECK_FALSE(server.step(0.01).has(StepFlag::Tuned));
}

} // namespace native_test
