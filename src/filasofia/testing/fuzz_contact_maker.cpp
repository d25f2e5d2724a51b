#include "filasofia/testing/fuzz_contact_maker.h"

#include "filasofia/geometry/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace filasofia::testing {
namespace {

namespace shapes = geometry::shapes;
using physics::RigidBodyDef;
using physics::SoftBodyDef;

constexpr double kMostEdges = 100.0; ///< [-] a thread's, about

/// A ball of tetrahedra: the block of a cube, of which every shell of nodes is drawn onto an ellipsoid.
std::shared_ptr<const geometry::TetMesh> ball(Vec3 size, int cells)
{
    geometry::TetMesh mesh = *shapes::block({2, 2, 2}, {cells, cells, cells});
    for (Vec3& x : mesh.nodes) {
        const double most = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}), far = length(x);
        if (far > 0.0) x = most / far * x;
        x = {0.5 * size.x * x.x, 0.5 * size.y * x.y, 0.5 * size.z * x.z};
    }
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

} // namespace

ContactSceneMaker::ContactSceneMaker(FuzzRandom& random, ContactScene& scene) : random_(random), scene_(scene)
{
    constexpr std::array rates{100.0, 250.0, 400.0, 1000.0, 1000.0, 1000.0, 4000.0}; // [1/s]
    scene.period = 1.0 / rates[static_cast<std::size_t>(random.below(rates.size()))];
    modulus_ = random.logarithmic(300.0, 1e6);
    friction_ = random.uniform(0.1, 1.0);
    size_ = random.logarithmic(0.01, 0.06);
    RigidBodyDef floor = rigid(shapes::box({4, 0.2, 4}), {{0, -0.1, 0}});
    floor.name = "floor";
    scene.bodies.emplace_back(floor);
}

double ContactSceneMaker::tissue(Vec3 at, double above)
{
    const Vec3 size{size_ * random_.uniform(0.6, 1.4), size_ * random_.uniform(0.5, 1.0),
                    size_ * random_.uniform(0.6, 1.4)};
    const auto cells = [&](double length) { return std::clamp(static_cast<int>(5.0 * length / size_), 2, 7); };
    SoftBodyDef def = soft({});
    switch (random_.below(3)) {
    case 0:
        def.mesh = shapes::block(size, {cells(size.x), cells(size.y), cells(size.z)});
        break;
    case 1:
        def.mesh = ball(size, 2 + random_.below(4));
        break;
    default: {
        const double radius = 0.5 * size.y, wall = radius * random_.uniform(0.2, 0.6);
        std::vector<Vec3> line;
        for (int i = 0; i <= 8; ++i) line.push_back({size.x * (i / 8.0 - 0.5), 0, 0});
        def.mesh = shapes::vessel(line, radius - wall, wall, {10, 2});
    }
    }
    at.y += above + 0.5 * size.y;
    def.pose.position = at;
    scene_.bodies.emplace_back(def);
    return size.y;
}

double ContactSceneMaker::box(Vec3 at, double above)
{
    const Vec3 size{size_ * random_.uniform(0.4, 1.0), size_ * random_.uniform(0.3, 0.8),
                    size_ * random_.uniform(0.4, 1.0)};
    at.y += above + 0.5 * size.y;
    RigidBodyDef def = rigid(shapes::box(size), {at});
    def.dynamic = true;
    def.mass = physics::Density{random_.logarithmic(200.0, 8000.0)};
    scene_.bodies.emplace_back(def);
    return size.y;
}

double ContactSceneMaker::sheet(double height)
{
    const double width = size_ * random_.uniform(1.5, 3.0);
    const int cells = 8 + random_.below(5);
    SoftBodyDef def = soft({0, height, 0});
    const double thickness = width * random_.logarithmic(0.01, 0.05);
    if (random_.chance(0.5)) {
        def.mesh = shapes::block({width, thickness, width}, {cells, 1, cells});
    } else {
        def.mesh = shapes::sheet(width, width, {cells, cells});
        def.material = physics::ShellMaterial{.youngModulus = modulus_, .thickness = thickness};
    }
    scene_.bodies.emplace_back(def);
    return width;
}

ToldBody& ContactSceneMaker::told(const std::shared_ptr<const geometry::TriangleMesh>& mesh, Pose from)
{
    scene_.told.push_back({.body = scene_.bodies.size(), .keys = {{0.0, from}}});
    scene_.bodies.emplace_back(rigid(mesh, from));
    return scene_.told.back();
}

std::shared_ptr<const geometry::TriangleMesh> ContactSceneMaker::tool()
{
    const double size = size_ * random_.uniform(0.2, 0.6);
    if (random_.chance(0.5)) return shapes::sphere(0.5 * size, 5);
    return shapes::box({size, size, size});
}

ToldBody& ContactSceneMaker::hand(Vec3 from)
{
    scene_.told.push_back({.body = scene_.bodies.size(), .keys = {{0.0, {from}}}});
    scene_.bodies.emplace_back(RigidBodyDef{.name = called(), .elements = {{from}}});
    return scene_.told.back();
}

SoftBodyDef ContactSceneMaker::soft(Vec3 at)
{
    physics::FemMaterial material{.youngModulus = modulus_ * random_.logarithmic(0.5, 2.0),
                                  .poissonRatio = random_.uniform(0.2, 0.49)};
    if (random_.chance(0.2)) material.law = physics::Corotational{};
    SoftBodyDef def{.name = called(), .pose = {at}, .material = material};
    def.rayleigh.mass = random_.uniform(1.0, 10.0);
    def.collision = {{.self = random_.chance(0.3)}};
    def.friction = friction_;
    return def;
}

RigidBodyDef ContactSceneMaker::rigid(const std::shared_ptr<const geometry::TriangleMesh>& mesh, const Pose& at) const
{
    RigidBodyDef def{.name = called(), .elements = {at}, .mesh = mesh};
    def.collision = {{}};
    def.friction = friction_;
    return def;
}

physics::RodBodyDef ContactSceneMaker::thread(std::vector<Vec3> points, bool closed)
{
    if (radius_ == 0.0) radius_ = random_.logarithmic(0.1e-3, 0.6e-3);
    double length = closed ? distance(points.back(), points.front()) : 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) length += distance(points[i - 1], points[i]);
    physics::RodBodyDef def{.name = called(), .points = std::move(points), .closed = closed};
    def.spacing = std::max(random_.uniform(2.5, 5.0) * radius_, length / kMostEdges);
    def.radius = radius_;
    def.youngModulus = random_.logarithmic(1e6, 5e9);
    def.rayleigh.mass = random_.uniform(1.0, 10.0);
    def.friction = friction_;
    def.collision = physics::RodCollision{};
    return def;
}

double ContactSceneMaker::grip(const physics::RodBodyDef& thread)
{
    double length = 0.0;
    for (std::size_t i = 1; i < thread.points.size(); ++i) length += distance(thread.points[i - 1], thread.points[i]);
    const double own = thread.youngModulus * std::numbers::pi * thread.radius * thread.radius / length;
    return std::min(random_.uniform(0.3, 3.0) * own, random_.uniform(0.05, 0.5) * modulus_ * thread.radius);
}

} // namespace filasofia::testing
