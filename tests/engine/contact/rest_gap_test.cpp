#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

#include <cmath>
#include <numbers>

// Walls of one body that are near each other at rest do not press each other apart.
namespace rest_gap_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A block of 12 x 8 x 8 mm whose upper half is parted at x = 0, where the walls stand `angle` [rad] apart.
std::shared_ptr<const geometry::TetMesh> notched(double angle)
{
    geometry::TetMesh mesh = *geometry::shapes::block({0.012, 0.008, 0.008}, {12, 8, 8});
    std::vector<int> twin(mesh.nodes.size(), -1);
    for (std::size_t n = 0; n < twin.size(); ++n)
        if (const Vec3 at = mesh.nodes[n]; std::abs(at.x) < 1e-9 && at.y > 1e-9) {
            twin[n] = static_cast<int>(mesh.nodes.size());
            mesh.nodes.push_back(at);
        }
    for (geometry::Tetrahedron& each : mesh.tetrahedra) {
        double x = 0.0;
        for (const int node : each) x += mesh.nodes[static_cast<std::size_t>(node)].x;
        if (x > 0.0)
            for (int& node : each)
                if (node < static_cast<int>(twin.size()) && twin[static_cast<std::size_t>(node)] >= 0)
                    node = twin[static_cast<std::size_t>(node)];
    }
    const double slope = std::tan(0.5 * angle);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        Vec3& at = mesh.nodes[n];
        const bool right = at.x > 1e-9 || n >= twin.size();
        const double part = 1.0 - std::abs(at.x) / 0.006; // the outer faces stay where they are
        at.x += (right ? 1.0 : -1.0) * part * slope * std::max(0.0, at.y);
    }
    return std::make_shared<const geometry::TetMesh>(mesh);
}

} // namespace

TEST_CASE("walls of a body that meet at an acute angle rest as they are")
{
    // A forked vessel pressed on itself with 1.9 N for ever, and elements in its crotch were inside out.
    for (const double degrees : {0.0, 0.05, 0.5, 3.0, 10.0}) {
        CAPTURE(degrees);
        Stage stage({.period = 1e-3, .threads = 1});
        physics::SoftBodyDef def{.name = "block", .mesh = notched(degrees * std::numbers::pi / 180.0)};
        def.gravity = false;
        def.collision = {{.self = true}};
        stage.add(def);
        stage.step(1e-3);
        const std::vector<Vec3> rest = stage.model().rest;
        double force = 0.0, off = 0.0;
        int inverted = 0;
        for (int i = 0; i < 200; ++i) {
            inverted += stage.step(1e-3).inverted.count;
            for (const frame::Contact& each : stage.world.scene().contactReports)
                force = std::max(force, each.normalForce);
        }
        for (std::size_t n = 0; n < rest.size(); ++n) off = std::max(off, distance(stage.soft().x[n], rest[n]));
        CHECK(inverted == 0);
        CHECK(force < 1e-6);
        CHECK(off < 1e-8);
    }
}

TEST_CASE("walls of a body that meet at an acute angle bear each other if they are pressed together")
{
    Stage stage({.period = 1e-3, .threads = 1});
    physics::SoftBodyDef def{.name = "block", .mesh = notched(3.0 * std::numbers::pi / 180.0)};
    def.gravity = false;
    def.collision = {{.self = true}};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0039, 1}}}};
    stage.add(def);
    physics::RigidBodyDef jaw{.name = "left", .elements = {{{-0.009, 0.002, 0}, {}}}};
    jaw.mesh = geometry::shapes::box({0.005, 0.003, 0.01});
    jaw.collision = {{}};
    const BodyId left = stage.add(jaw);
    jaw.name = "right";
    jaw.elements = {{{0.009, 0.002, 0}, {}}};
    const BodyId right = stage.add(jaw);
    double own = 0.0, jaws = 0.0;
    for (int i = 0; i < 600; ++i) {
        const double place = 0.009 - std::min(1.6e-3, 8e-6 * i);
        stage.post(physics::SetPose{left, 0, {{-place, 0.002, 0}, {}}});
        stage.post(physics::SetPose{right, 0, {{place, 0.002, 0}, {}}});
        CHECK(stage.step(1e-3).inverted.count == 0);
        own = jaws = 0.0;
        for (const frame::Contact& each : stage.world.scene().contactReports) {
            (each.first == each.second ? own : jaws) += each.normalForce;
            CHECK(each.gap > -0.1e-3); // as far as corners sink in
        }
    }
    CHECK(jaws > 0.1);
    CHECK(own > 0.2 * jaws); // what both jaws give passes through the gap, as far as the base does not bear it
}

} // namespace rest_gap_test
