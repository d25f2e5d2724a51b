#include "filasofia/testing/fuzz_contact_scene.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/fuzz_contact_maker.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::testing {
namespace {

namespace shapes = geometry::shapes;
using physics::RigidBodyDef;

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
    constexpr std::array names{"drop",   "heap",  "press",        "jaws",          "drape",
                               "plates", "blade", "threads fall", "threads drawn", "needle"};
    static_assert(names.size() == static_cast<std::size_t>(ContactKind::count_));
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
    scene.tools = kind >= kFirstToolKind;
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
    case ContactKind::Blade:
        makeBlade(make, random, scene);
        break;
    case ContactKind::ThreadsFall:
        makeFallingThreads(make, random, scene);
        break;
    case ContactKind::ThreadsDrawn:
        makeDrawnThreads(make, random, scene);
        break;
    case ContactKind::Needle:
        makeNeedle(make, random, scene);
        break;
    case ContactKind::count_:
        break;
    }
    return scene;
}

} // namespace filasofia::testing
