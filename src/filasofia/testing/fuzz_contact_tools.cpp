#include "filasofia/testing/fuzz_contact_maker.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/fuzz_blade.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::testing {
namespace {

namespace shapes = geometry::shapes;
using physics::RigidBodyDef;
using physics::SoftBodyDef;

constexpr double kRests = 0.3; ///< [s] at the start, before tools move

/// Holds the last body at what is now in a box.
void hold(ContactScene& scene, Vec3 low, Vec3 high)
{
    physics::AttachmentDef pins;
    pins.box = geometry::Box{low, high};
    std::get<SoftBodyDef>(scene.bodies.back()).attachments.push_back(pins);
}

/// Goes on to a place at this speed, as it is turned now.
void go(ToldBody& told, Vec3 to, double speed)
{
    const ToldBody::Key last = told.keys.back();
    told.keys.push_back({last.time + distance(last.pose.position, to) / speed, {to, last.pose.orientation}});
}

/// A line of this length about a place, in a random direction that is nearly level.
std::vector<Vec3> levelLine(FuzzRandom& random, Vec3 middle, double length)
{
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vec3 half = 0.5 * length * Vec3{std::cos(angle), random.uniform(-0.05, 0.05), std::sin(angle)};
    return {middle - half, middle + half};
}

std::vector<Vec3> ringLine(Vec3 middle, double radius)
{
    std::vector<Vec3> points;
    for (int k = 0; k < 24; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 24;
        points.push_back(middle + radius * Vec3{std::cos(angle), 0, std::sin(angle)});
    }
    return points;
}

} // namespace

/// A blade goes through an organ that lies or is held, or through a sheet that is held at one side or at both; once, or
/// there and back.
void makeBlade(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    Vec3 middle;
    double size = make.size();
    if (random.chance(0.6)) {
        const double height = make.tissue({}, kApart);
        middle.y = kApart + 0.5 * height;
        if (random.chance(0.5)) hold(scene, {-1, -1, -1}, {1, kApart + 0.15 * height, 1});
        std::get<SoftBodyDef>(scene.bodies.back()).dynamicTopology = true;
        if (random.chance(0.3)) make.tissue({0.1 * size, 0, 0}, 2 * kApart + height); // it is cut by chance
        std::get<SoftBodyDef>(scene.bodies.back()).dynamicTopology = true;
    } else {
        middle.y = size;
        const double width = make.sheet(middle.y);
        std::get<SoftBodyDef>(scene.bodies.back()).dynamicTopology = true;
        hold(scene, {-1, -1, -1}, {-0.42 * width, 1, 1});
        if (random.chance(0.5)) hold(scene, {0.42 * width, -1, -1}, {1, 1, 1});
    }
    const Vec3 along = random.direction(), other = random.direction();
    const Vec3 across =
        normalized(cross(along, std::abs(dot(along, other)) > 0.9 ? Vec3{along.y, along.z, along.x} : other));
    const Vec3 normal = cross(across, along);
    const Quat turn = frameOf(across, along);
    const Vec3 through = middle + 0.3 * size * random.uniform(-1.0, 1.0) * normal;
    const Vec3 outside = through - 1.8 * size * along;
    const double beyond = size * (random.chance(0.6) ? 1.8 : random.uniform(-0.4, 0.6));
    RigidBodyDef blade{.name = "blade", .elements = {{outside, turn}}};
    blade.collision = {{.mesh = bladeOf(size), .proximity = 0, .cutting = true}};
    ToldBody told{.body = scene.bodies.size(), .keys = {{0.0, {outside, turn}}, {kRests, {outside, turn}}}};
    const double speed = random.logarithmic(0.05, 1.0);
    go(told, through + beyond * along, speed);
    if (random.chance(0.4)) go(told, outside, speed);
    scene.acts = told.keys.back().time;
    scene.told.push_back(std::move(told));
    scene.bodies.emplace_back(std::move(blade));
}

/// Threads and rings fall onto tissue, boxes, tools or a sheet.
void makeFallingThreads(ContactSceneMaker& make, FuzzRandom& random, ContactScene&)
{
    double top = 0.0;
    switch (random.below(4)) {
    case 0:
        top = kApart + make.box({}, kApart);
        break;
    case 1: {
        const double radius = 0.4 * make.size();
        make.told(random.chance(0.5) ? shapes::sphere(radius, 6) : shapes::box({radius, 2 * radius, radius}),
                  {{0, radius, 0}});
        top = 2 * radius;
        break;
    }
    default:
        top = kApart + make.tissue({}, kApart);
    }
    top += kApart + random.uniform(0.0, 0.05);
    const int count = 1 + random.below(3);
    for (int i = 0; i < count; ++i, top += 2 * kApart) {
        const Vec3 middle{make.size() * random.uniform(-0.3, 0.3), top + 0.1 * make.size(),
                          make.size() * random.uniform(-0.3, 0.3)};
        top = middle.y + 0.1 * make.size();
        const auto def = random.chance(0.25)
                             ? make.thread(ringLine(middle, make.size() * random.uniform(0.3, 0.7)), true)
                             : make.thread(levelLine(random, middle, make.size() * random.uniform(1.0, 3.0)));
        make.add(def);
    }
}

/// Hands at both ends of a thread bring it down onto tissue or a tool, draw it across, and hold it there.
void makeDrawnThreads(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    double height = 0.0;
    if (random.chance(0.6)) {
        height = kApart + make.tissue({}, kApart);
        if (random.chance(0.7)) hold(scene, {-1, -1, -1}, {1, kApart + 0.15 * height, 1});
    } else {
        height = 0.8 * make.size();
        make.told(random.chance(0.5) ? shapes::sphere(0.5 * height, 6) : shapes::box({height, height, height}),
                  {{0, 0.5 * height, 0}});
    }
    const int count = 1 + random.below(2);
    for (int i = 0; i < count; ++i) {
        const double y = height + (2 + 2 * i) * kApart + 0.1 * make.size() * i;
        physics::RodBodyDef def = make.thread(levelLine(random, {0, y, 0}, make.size() * random.uniform(2.0, 3.0)));
        for (Vec3& p : def.points) p.y = y;
        const double speed = random.logarithmic(0.02, 1.0), down = height * random.uniform(0.2, 1.0);
        const Vec3 aside =
            make.size() * Vec3{random.uniform(-0.6, 0.6), random.uniform(0.0, 0.4), random.uniform(-0.6, 0.6)};
        const int last = static_cast<int>(physics::centreLine(def).size()) - 1;
        const double stiffness = make.grip(def);
        const bool both = random.chance(0.8);
        for (const int end : {0, 1}) {
            if (end == 1 && !both) continue;
            const Vec3 from = def.points[static_cast<std::size_t>(end)];
            const auto hand = static_cast<std::uint32_t>(scene.bodies.size() + 1);
            ToldBody& told = make.hand(from);
            told.keys.push_back({kRests, {from}});
            go(told, from - Vec3{0, down, 0}, speed);
            go(told, from - Vec3{0, down, 0} + aside, speed);
            scene.acts = std::max(scene.acts, told.keys.back().time);
            def.attachments.push_back({.nodes = {end * last}, .stiffness = stiffness, .to = BodyId{hand}});
        }
        make.add(def);
    }
}

/// A needle with a thread goes into a block that is held at two sides: a straight one down, or a curved one in and out
/// at the top. It stops, comes back, or draws its thread on.
void makeNeedle(ContactSceneMaker& make, FuzzRandom& random, ContactScene& scene)
{
    const Vec3 size{make.size() * random.uniform(1.0, 1.6), make.size() * random.uniform(0.2, 0.6),
                    make.size() * random.uniform(0.8, 1.4)};
    const double top = 4.0 * make.size(), radius = 0.01 * make.size() * random.uniform(0.8, 2.0);
    SoftBodyDef block = make.soft({0, top - 0.5 * size.y, 0});
    block.mesh = shapes::block(size, {6, 3, 5});
    const double modulus = std::get<physics::FemMaterial>(block.material).youngModulus;
    const double force = modulus * radius * size.y * random.uniform(0.3, 2.0);
    block.puncture = physics::PunctureDef{.force = force,
                                          .cutting = force * random.uniform(0.1, 0.5),
                                          .friction = modulus * radius * random.uniform(0.05, 0.5)};
    make.add(block);
    hold(scene, {-1, -1, -1}, {-0.4 * size.x, 9, 1});
    hold(scene, {0.4 * size.x, -1, -1}, {1, 9, 1});

    const bool curved = random.chance(0.5);
    const double reach = curved ? 0.3 * size.x : size.y * random.uniform(1.2, 2.5); // radius of the arc, or length
    const double lean = random.uniform(-0.4, 0.4);
    const std::vector<Vec3> line = curved ? shapes::arc(reach, 0.0, 2.6) : std::vector<Vec3>{{}, {0, reach, 0}};
    const double speed = random.logarithmic(0.02, 0.5);
    Pose now = curved ? Pose{{0, top + reach * random.uniform(0.2, 0.6), 0}, axisAngle({0, 0, 1}, 0.1)}
                      : Pose{{0, top + 2 * kApart, 0}, axisAngle({0, 0, 1}, lean)};
    if (curved) now.orientation = axisAngle({0, 1, 0}, 0.7 * lean) * now.orientation; // askew across the block
    ToldBody told{.body = scene.bodies.size(), .keys = {{0.0, now}, {kRests, now}}};
    RigidBodyDef needle = make.rigid(shapes::tube(line, radius, 8, true), now);
    needle.needle = physics::NeedleDef{
        .line = line, .radius = radius, .spacing = std::max(1e-3, 0.05 * reach) < 0.4 * reach ? 0.05 * reach : 1e-3};
    const BodyId id{static_cast<std::uint32_t>(scene.bodies.size() + 1)};
    scene.bodies.emplace_back(needle);

    const auto turnOn = [&](double angle) { // in parts, as keys turn the shortest way
        for (int i = 0; i < 4; ++i) {
            now.orientation = now.orientation * axisAngle({0, 0, 1}, -0.25 * angle);
            told.keys.push_back({told.keys.back().time + 0.25 * std::abs(angle) * reach / speed, now});
        }
    };
    const bool back = random.chance(0.25);
    if (curved) {
        const double angle = random.uniform(1.0, std::numbers::pi + 2.8);
        turnOn(angle);
        if (back) turnOn(-angle);
    } else {
        const Vec3 from = now.position, way = rotate(now.orientation, {0, -1, 0});
        go(told, from + random.uniform(0.3, 1.0) * (size.y + 2.0 * reach) * way, speed);
        if (back) go(told, from, speed);
    }
    scene.acts = told.keys.back().time;
    const Vec3 tail = transform(scene.told.emplace_back(std::move(told)).keys.front().pose, line.back());
    physics::RodBodyDef thread = make.thread({tail, tail + Vec3{0, 2.0 * make.size() * random.uniform(0.6, 1.5), 0}});
    thread.radius = std::min(thread.radius, 0.7 * radius);
    thread.attachments = {{.nodes = {0}, .to = id}};
    make.add(thread);
}

} // namespace filasofia::testing
