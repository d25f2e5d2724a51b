#include "filasofia/core/error.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_server.h"

#include "engine/stage.h"

#include <numbers>

namespace build_rod_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

RodBodyDef thread() { return {.name = "silk", .points = {{0, 0, 0}, {0.1, 0, 0}}, .spacing = 0.01}; }

void checkError(const RodBodyDef& def, const std::string& part)
{
    std::string error;
    try {
        static_cast<void>(buildBody(def, 1e-3));
    } catch (const Error& caught) {
        error = caught.what();
    }
    INFO(error);
    CHECK(error.find("rod 'silk'") == 0);
    CHECK(error.find(part) != std::string::npos);
}

} // namespace

TEST_CASE("a rod has the mass of its volume, and nodes at equal distances along its line")
{
    RodBodyDef def = thread();
    def.points = {{0, 0, 0}, {0.05, 0, 0}, {0.05, 0.05, 0}};
    def.pose = {{0, 0, 1}, {}};
    const auto built = buildBody(def, 1e-3);
    const SoftModel& model = dynamic_cast<BuiltSoftBody&>(*built).body.model;
    CHECK(built->nodeCount() == 11);
    CHECK(distance(model.rest[4], {0.04, 0, 1}) < 1e-15);
    CHECK(distance(model.rest[5], {0.05, 0, 1}) < 1e-15);
    CHECK(distance(model.rest.back(), {0.05, 0.05, 1}) < 1e-15);
    double mass = 0.0;
    for (double each : model.masses) mass += each;
    CHECK_THAT(mass, Catch::WithinRel(def.density * std::numbers::pi * def.radius * def.radius * 0.1, 1e-12));

    def.spacing = {};
    CHECK(buildBody(def, 1e-3)->nodeCount() == 3);
}

TEST_CASE("a ring has as many edges and joints as nodes, and the mass of its whole length")
{
    RodBodyDef def = thread();
    def.closed = true;
    def.twist = 3.0;
    def.points = {{0, 0, 0}, {0.05, 0, 0}, {0.05, 0.05, 0}, {0, 0.05, 0}};
    const auto built = buildBody(def, 1e-3);
    const SoftBody& body = dynamic_cast<BuiltSoftBody&>(*built).body;
    CHECK(built->nodeCount() == 20);
    CHECK(body.model.rod.edges.size() == 20);
    CHECK(body.model.rod.joints.size() == 20);
    CHECK(body.model.rod.edges.back().nodes == std::array{19, 0});
    double mass = 0.0, twist = 0.0;
    for (double each : body.model.masses) mass += each;
    for (double each : body.state.rod.twists) twist += each;
    CHECK_THAT(mass, Catch::WithinRel(def.density * std::numbers::pi * def.radius * def.radius * 0.2, 1e-12));
    CHECK_THAT(twist, Catch::WithinRel(3.0, 1e-12));
}

TEST_CASE("what cannot be a rod is refused with one Error that names the rod, the field and the value")
{
    const auto with = [](const auto& change) {
        RodBodyDef def = thread();
        change(def);
        return def;
    };
    checkError(with([](RodBodyDef& d) { d.points = {{0, 0, 0}}; }), "points must have at least 2 entries, got 1");
    checkError(with([](RodBodyDef& d) { d.spacing = {}; }), "points must be in [3, 100000] without a spacing, got 2");
    checkError(with([](RodBodyDef& d) { d.points.push_back({0.1, 0, 0}); }), "points[1] and points[2] must be apart");
    checkError(with([](RodBodyDef& d) { d.points.push_back({0, 0.001, 0}); }), "must turn by less than 168 degrees");
    checkError(with([](RodBodyDef& d) { d.points.push_back({2e4, 0, 0}); }), "points[2] must lie within 10000 m");
    checkError(with([](RodBodyDef& d) { d.points.push_back({0, std::nan(""), 0}); }), "points");
    checkError(with([](RodBodyDef& d) { d.spacing = 1e-9; }), "spacing must leave at most 100000 nodes");
    checkError(with([](RodBodyDef& d) { d.spacing = 5.0; }), "spacing must be < the rod's length, ");
    checkError(with([](RodBodyDef& d) { d.closed = true; }), "points must have at least 3 entries for a ring, got 2");
    const auto ring = with([](RodBodyDef& d) {
        d.closed = true;
        d.spacing = {};
        d.points = {{0, 0, 0}, {0.1, 0, 0}, {0.05, 0.1, 0}};
    });
    checkError(ring, "points must be in [8, 100000] without a spacing, got 3");
    const auto repeated = with([](RodBodyDef& d) {
        d.closed = true;
        d.points = {{0, 0, 0}, {0.1, 0, 0}, {0.05, 0.1, 0}, {0, 0, 0}};
    });
    checkError(repeated, "points[3] and points[0] must be apart");
    checkError(with([](RodBodyDef& d) { d.spacing = 0.0; }), "spacing must be > 0 m, got 0");
    checkError(with([](RodBodyDef& d) { d.radius = 0.0; }), "radius must be > 0 m, got 0");
    checkError(with([](RodBodyDef& d) { d.youngModulus = -1.0; }), "youngModulus must be > 0 Pa, got -1");
    checkError(with([](RodBodyDef& d) { d.poissonRatio = 0.6; }), "poissonRatio must be in [0, 0.5], got 0.6");
    checkError(with([](RodBodyDef& d) { d.density = 0.0; }), "density must be > 0 kg/m^3, got 0");
    checkError(with([](RodBodyDef& d) { d.twist = std::nan(""); }), "twist must be finite");
    checkError(with([](RodBodyDef& d) { d.breakForce = 0.0; }), "breakForce must be > 0 N, got 0");
    checkError(with([](RodBodyDef& d) { d.breakForce = 2.0; }),
               "breakForce must be infinite without dynamicTopology, got 2 N");
    checkError(with([](RodBodyDef& d) { d.yieldStrain = 0.0; }), "yieldStrain must be > 0, got 0");
    checkError(with([](RodBodyDef& d) { d.hardening = 1.0; }), "hardening must be in [0, 1), got 1");
    checkError(with([](RodBodyDef& d) { d.hardening = 0.1; }), "hardening must be 0 without a yieldStrain, got 0.1");
    checkError(with([](RodBodyDef& d) { d.friction = -0.1; }), "friction must be >= 0");
    checkError(with([](RodBodyDef& d) { d.collision = RodCollision{.proximity = -1.0}; }), "proximity must be >= 0 m");
    checkError(with([](RodBodyDef& d) { d.attachments = {{.nodes = {11}}}; }), "nodes must be in [0, 11), got 11");
    checkError(with([](RodBodyDef& d) { d.forces = {{.node = 11}}; }), "forces[0].node must be in [0, 11), got 11");
    checkError(with([](RodBodyDef& d) { d.pose.orientation = {0, 0, 0, 0}; }), "pose");
}

TEST_CASE("commands that a rod cannot follow are refused, and those for nodes are obeyed")
{
    PhysicsServer server(makeNativeEngine());
    const BodyId rod = server.add(thread());
    CHECK_THROWS_WITH(server.setPressure(rod, 1.0), Catch::Contains("rod 'silk': must be a soft body"));
    CHECK_THROWS_WITH(server.setMaterial(rod, FemMaterial{}), Catch::Contains("rod 'silk': must be a soft body"));
    CHECK_THROWS_WITH(server.setPose(rod, {}), Catch::Contains("rod 'silk': must be a rigid body"));
    CHECK_THROWS_WITH(server.setForces(rod, {{.node = 11}}), Catch::Contains("rod 'silk': forces[0].node"));
    const auto refuse = [&](std::vector<RodSection> sections, double rate, const char* why) {
        CHECK_THROWS_WITH(server.setCurvature(rod, std::move(sections), rate), Catch::Contains(why));
    };
    refuse({{.begin = 0.1}}, 1.0, "rod 'silk': sections[0].begin must be in [0, 0.1) m, the rod's length, got 0.1");
    refuse({{.begin = -1e-3}}, 1.0, "sections[0].begin must be >= 0 m, got -0.001");
    refuse({{.begin = 0.02, .end = 0.02}}, 1.0, "sections[0].end must be > begin, 0.02 m, got 0.02");
    refuse({{.end = 0.11}}, 1.0, "sections[0].end must be at most 0.1 m, the rod's length, got 0.11");
    refuse({{.end = 0.05}, {.begin = 0.04}}, 1.0,
           "sections[1].begin must be >= 0.05 m, where sections[0] ends, got 0.04");
    refuse({{}, {.begin = 0.02}}, 1.0,
           "rod 'silk': sections[0].end must be given, at most 0.02 m: without it the section ends with the rod and "
           "overlaps sections[1]");
    refuse({{.curvature = {0.0, 300.0}}}, 1.0, "sections[0].curvature must be at most ");
    try { // the bound is one that a person can type, and is within it
        server.setCurvature(rod, {{.curvature = {0.0, 300.0}}});
    } catch (const Error& error) {
        const std::string what = error.what(), before = "at most ";
        const std::string bound = what.substr(what.find(before) + before.size());
        CHECK(bound.find(' ') <= 5);
        CHECK_NOTHROW(server.setCurvature(rod, {{.curvature = {0.0, std::stod(bound)}}}));
    }
    refuse({{.curvature = {std::nan(""), 0.0}}}, 1.0, "sections[0].curvature[0] must be finite");
    refuse({}, 0.0, "rate must be > 0 1/(m s), got 0");
    CHECK_THROWS_WITH(server.removePiece(rod, 1), Catch::Contains("rod 'silk': piece 1 cannot be removed"));
    const BodyId stone = server.add(RigidBodyDef{.name = "stone"});
    CHECK_THROWS_WITH(server.setCurvature(stone, {}), Catch::Contains("rigid body 'stone': must be a rod"));
    server.setCurvature(rod, {{.end = 0.05, .curvature = {3.0, 4.0}}, {.begin = 0.05}});
    server.setCurvature(rod, {});
    server.setGravity({});
    server.setForces(rod, {{.node = 10, .force = {1e-5, 0, 0}}});
    server.attach(rod, {.nodes = {0, 1}});
    for (int i = 0; i < 20; ++i) server.step(1e-3);
    CHECK(server.latest()->softBody(rod)->positions[10].x > 0.1);
    CHECK(length(server.latest()->softBody(rod)->positions[0]) < 1e-6);
}

} // namespace build_rod_test
