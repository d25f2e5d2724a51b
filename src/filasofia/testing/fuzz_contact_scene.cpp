#include "filasofia/testing/fuzz_contact_scene.h"

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

constexpr double kApart = 3e-3; ///< [m] between bodies at the start

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

/// Adds bodies to a scene, which share a kind of tissue and a friction.
class ContactSceneMaker {
public:
    ContactSceneMaker(FuzzRandom& random, ContactScene& scene) : random_(random), scene_(scene)
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
    [[nodiscard]] double size() const { return size_; }

    /// A soft body whose lowest point is at height `above`; returns its own height.
    double tissue(Vec3 at, double above)
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
    /// A dynamic box; the same.
    double box(Vec3 at, double above)
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
    /// A sheet of tetrahedra, or a shell, at this height.
    void sheet(double height)
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
    }
    /// A body that goes where it is told, at first at `from`.
    ToldBody& told(const std::shared_ptr<const geometry::TriangleMesh>& mesh, Pose from)
    {
        scene_.told.push_back({.body = scene_.bodies.size(), .keys = {{0.0, from}}});
        scene_.bodies.emplace_back(rigid(mesh, from));
        return scene_.told.back();
    }
    std::shared_ptr<const geometry::TriangleMesh> tool()
    {
        const double size = size_ * random_.uniform(0.2, 0.6);
        if (random_.chance(0.5)) return shapes::sphere(0.5 * size, 5);
        return shapes::box({size, size, size});
    }

private:
    SoftBodyDef soft(Vec3 at)
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
    RigidBodyDef rigid(const std::shared_ptr<const geometry::TriangleMesh>& mesh, const Pose& at)
    {
        RigidBodyDef def{.name = called(), .elements = {at}, .mesh = mesh};
        def.collision = {{}};
        def.friction = friction_;
        return def;
    }
    [[nodiscard]] std::string called() const { return "body " + std::to_string(scene_.bodies.size() + 1); }

    FuzzRandom& random_;
    ContactScene& scene_;
    double modulus_, friction_, size_;
};

void makeDrop(ContactSceneMaker& make, FuzzRandom& random)
{
    double top = random.uniform(0.0, 0.05);
    for (int i = 0; i < 2; ++i) {
        const Vec3 at{0.2 * make.size() * i, 0, 0.1 * make.size() * i};
        top += kApart + (random.chance(0.7) ? make.tissue(at, top + kApart) : make.box(at, top + kApart));
    }
}

void makeHeap(ContactSceneMaker& make, FuzzRandom& random)
{
    double top = 0.0;
    const int count = 4 + random.below(4);
    for (int i = 0; i < count; ++i) {
        const Vec3 at{make.size() * random.uniform(-0.3, 0.3), 0, make.size() * random.uniform(-0.3, 0.3)};
        top += kApart + (random.chance(0.3) ? make.tissue(at, top + kApart) : make.box(at, top + kApart));
    }
}

/// A tool comes down into tissue on the floor, stays there, or goes up again.
void makePress(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    const double height = make.tissue({}, kApart);
    const double speed = random.logarithmic(0.02, 1.0), way = height * random.uniform(0.1, 0.6);
    const double high = kApart + height + 0.35 * make.size() + kApart;
    const double x = make.size() * random.uniform(-0.3, 0.3);
    ToldBody& tool = make.told(make.tool(), {{x, high, 0}});
    const double begin = 0.3, end = begin + (way + 2 * kApart) / speed;
    tool.keys.push_back({begin, {{x, high, 0}}});
    tool.keys.push_back({end, {{x, high - way - 2 * kApart, 0}}});
    scene.acts = end;
    if (random.chance(0.5)) return;
    tool.keys.push_back({end + 0.2, {{x, high - way - 2 * kApart, 0}}});
    tool.keys.push_back({end + 0.2 + (high - kApart) / speed, {{x, high + way, 0}}});
    scene.acts = end + 0.2 + (high - kApart) / speed;
}

/// Two jaws close on tissue from the sides, and lift it or not.
void makeJaws(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    make.tissue({}, kApart);
    const double open = 1.6 * make.size(), closed = make.size() * random.uniform(0.2, 0.8);
    const double speed = random.logarithmic(0.02, 0.5), end = 0.3 + 0.5 * (open - closed) / speed;
    const double lift = random.chance(0.5) ? make.size() : 0.0;
    const Vec3 jaw{0.2 * make.size(), 0.4 * make.size(), 0.8 * make.size()};
    for (const double side : {-1.0, 1.0}) {
        const auto at = [&](double gap, double y) {
            return Pose{{side * 0.5 * (gap + jaw.x), kApart + 0.5 * jaw.y + y, 0}};
        };
        ToldBody& told = make.told(shapes::box(jaw), at(open, 0.0));
        told.keys.push_back({0.3, at(open, 0.0)});
        told.keys.push_back({end, at(closed, 0.0)});
        if (lift > 0.0) told.keys.push_back({end + lift / speed, at(closed, lift)});
    }
    scene.acts = end + lift / speed;
}

/// A sheet falls over a body that stands still.
void makeDrape(ContactSceneMaker& make, FuzzRandom& random)
{
    const double radius = 0.4 * make.size();
    make.told(random.chance(0.5) ? shapes::sphere(radius, 6) : shapes::box({radius, 2 * radius, radius}),
              {{0, radius, 0}});
    make.sheet(2 * radius + kApart);
}

/// Two plates press tissue together from both sides, one of them free and heavy.
void makePlates(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    double top = kApart + make.tissue({}, kApart);
    if (random.chance(0.5)) top += kApart + make.tissue({}, top + kApart);
    const double width = 3.0 * make.size(), thick = 0.2 * make.size();
    RigidBodyDef plate{.name = "plate", .elements = {{{0, top + kApart + 0.5 * thick, 0}}}};
    plate.mesh = shapes::box({width, thick, width});
    plate.dynamic = true;
    plate.mass = physics::Density{random.logarithmic(500.0, 8000.0)};
    plate.collision = {{}};
    scene.bodies.emplace_back(plate);
}

} // namespace

const char* name(ContactKind kind)
{
    constexpr std::array names{"drop", "heap", "press", "jaws", "drape", "plates"};
    return names[static_cast<std::size_t>(kind)];
}

Pose ToldBody::at(double time) const
{
    const auto next = std::ranges::upper_bound(keys, time, {}, &Key::time);
    if (next == keys.begin()) return keys.front().pose;
    if (next == keys.end()) return keys.back().pose;
    const Key& last = *std::prev(next);
    return between(last.pose, next->pose, (time - last.time) / (next->time - last.time));
}

ContactScene contactScene(ContactKind kind, FuzzRandom& random)
{
    ContactScene scene;
    ContactSceneMaker make(random, scene);
    switch (kind) {
    case ContactKind::Drop:
        makeDrop(make, random);
        break;
    case ContactKind::Heap:
        makeHeap(make, random);
        break;
    case ContactKind::Press:
        makePress(make, random, scene);
        break;
    case ContactKind::Jaws:
        makeJaws(make, random, scene);
        break;
    case ContactKind::Drape:
        makeDrape(make, random);
        break;
    case ContactKind::Plates:
        makePlates(make, random, scene);
        break;
    case ContactKind::count_:
        break;
    }
    return scene;
}

} // namespace filasofia::testing
