#include "filasofia/testing/fuzz_knot_scene.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/knot_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace filasofia::testing {
namespace {

using physics::RigidBodyDef;
using physics::RodBodyDef;
using physics::SoftBodyDef;

constexpr double kCloses = 0.1; ///< [s] in which jaws close
constexpr double kReach = 60.0; ///< [-] tools', in radii of threads

/// Adds bodies to a scene whose threads are all of one random kind.
class SceneMaker {
public:
    SceneMaker(FuzzRandom& random, KnotScene& scene) : random_(random), scene_(scene)
    {
        radius_ = scene.radius = random.logarithmic(0.1e-3, 0.6e-3);
        modulus_ = random.logarithmic(1e6, 5e9);
        friction_ = random.uniform(0.0, 0.8);
        damping_ = random.uniform(0.0, 5.0);
        edge_ = random.uniform(2.5, 5.0); // in radii
    }
    [[nodiscard]] double radius() const { return radius_; }

    /// A thread along these points, which hands hold at some of its nodes, given as shares of its length.
    void thread(const std::vector<Vec3>& points, const std::vector<double>& held, bool closed = false,
                std::optional<std::size_t> needle = {})
    {
        RodBodyDef def{.points = points, .closed = closed, .spacing = edge_ * radius_, .radius = radius_};
        def.name = "thread " + std::to_string(scene_.bodies.size() + 1);
        def.youngModulus = modulus_;
        def.friction = friction_;
        def.rayleigh.mass = damping_;
        def.collision = physics::RodCollision{.proximity = random_.uniform(0.2, 1.0) * radius_};
        const std::vector<Vec3> nodes = physics::centreLine(def);
        const double length = edge_ * radius_ * static_cast<double>(nodes.size());
        // A hand gives way at most as the thread itself does, so it draws hard, but not without bound.
        const double stiffness = modulus_ * std::numbers::pi * radius_ * radius_ / length;
        for (const double share : held) {
            const int last = static_cast<int>(nodes.size()) - 1;
            const int node = std::clamp(static_cast<int>(share * (last + 1)), 0, last);
            const std::size_t by = hand(nodes[static_cast<std::size_t>(node)], 0.35 * length);
            physics::AttachmentDef grip{.nodes = {node}, .to = BodyId{static_cast<std::uint32_t>(by + 1)}};
            grip.stiffness = std::min(random_.logarithmic(20.0, 2000.0), random_.uniform(0.3, 3.0) * stiffness);
            // Tissue bears a thread up to a force that grows with its modulus: beyond it, it would be cut.
            if (tissue_ > 0.0)
                grip.stiffness = std::min(grip.stiffness, random_.uniform(0.05, 0.5) * tissue_ * radius_);
            def.attachments.push_back(grip);
        }
        if (needle) {
            def.attachments.push_back({.nodes = {0}, .to = BodyId{static_cast<std::uint32_t>(*needle + 1)}});
            scene_.lines.back().thread = scene_.bodies.size();
        } else {
            scene_.lines.push_back({.body = scene_.bodies.size(), .closed = closed});
        }
        scene_.bodies.emplace_back(def);
    }
    /// A curved needle with a thread at its tail, in the plane z = 0 around `centre`: a driver holds it, a hand that
    /// yields, or nothing but its thread.
    void needle(Vec3 centre, double arc, double thick, const std::vector<Vec3>& onwards)
    {
        const std::vector<Vec3> axis = geometry::shapes::arc(arc, 0.0, 2.6, 20);
        const int held = random_.below(3);
        RigidBodyDef def{.name = "needle", .elements = {Pose{centre}}};
        if (held == 1) { // several points also hold its direction
            const std::size_t by = hand(centre, kReach * radius_);
            scene_.hands.back().turns = true;
            def.attachments = {{.points = {axis[5], axis[10], axis[15]}, .stiffness = soft(0.1, 0.5)}};
            def.attachments.front().to = BodyId{static_cast<std::uint32_t>(by + 1)};
        }
        def.mesh = geometry::shapes::tube(axis, thick, 8);
        def.dynamic = held > 0;
        def.mass = physics::Density{7800.0};
        def.linearDamping = def.angularDamping = 5.0;
        def.collision = {{.proximity = 0.5 * radius_}};
        def.friction = friction_;
        const std::size_t body = scene_.bodies.size();
        if (held == 0) {
            FuzzHand driver{.body = body, .home = centre, .reach = kReach * radius_, .turns = true};
            driver.now = Pose{centre};
            driver.target = centre;
            scene_.hands.push_back(driver);
        }
        scene_.lines.push_back({.body = body, .axis = axis});
        scene_.bodies.emplace_back(def);
        std::vector<Vec3> points{centre + axis.back()};
        for (const Vec3 p : onwards) points.push_back(points.front() + p);
        const bool drawn = held == 2 || random_.chance(0.5);
        thread(points, drawn ? std::vector<double>{1.0} : std::vector<double>{}, false, body);
    }
    /// Two jaws along z, one above and one below a place, that press together what is between them and are drawn about.
    void jaws(Vec3 place, std::size_t thread)
    {
        const double length = 30.0 * radius_, thick = random_.uniform(3.0, 8.0) * radius_;
        RigidBodyDef carrier{.name = "handle"};
        FuzzHand mover{.body = scene_.bodies.size(), .home = place, .reach = kReach * radius_, .turns = true};
        mover.opens = thick + 8.0 * radius_;
        // The springs of a jaw are as long as this when it presses.
        mover.closed = thick + 2.0 * radius_ * (1.0 - random_.uniform(0.1, 1.0));
        mover.now = Pose{place};
        mover.target = place;
        carrier.elements = {mover.jaw(0, 0.0), mover.jaw(1, 0.0)};
        scene_.hands.push_back(mover);
        scene_.bodies.emplace_back(carrier);
        const bool grasps = random_.chance(0.5);
        for (const int which : {0, 1}) {
            RigidBodyDef def{.name = which == 0 ? "upper jaw" : "lower jaw", .elements = {mover.jaw(which, 0.0)}};
            def.mesh = geometry::shapes::box({2.0 * thick, thick, length});
            def.dynamic = true;
            def.mass = physics::Density{7800.0};
            def.linearDamping = def.angularDamping = 5.0;
            def.collision = {{.proximity = 0.5 * radius_}};
            def.friction = friction_;
            const double half = 0.5 * length;
            def.attachments = {
                {.points = {{thick, 0, -half}, {-thick, 0, -half}, {thick, 0, half}, {-thick, 0, half}}}};
            def.attachments.front().stiffness = soft(0.1, 1.0);
            def.attachments.front().to = BodyId{static_cast<std::uint32_t>(mover.body + 1)};
            def.attachments.front().toElement = which;
            if (grasps) scene_.grasps.push_back({1.2 * kCloses, scene_.bodies.size(), thread});
            scene_.lines.push_back({.body = scene_.bodies.size(), .axis = {{0, 0, -half}, {0, 0, half}}});
            scene_.bodies.emplace_back(def);
        }
    }
    /// A soft cylinder along z, solid or hollow, that both ends hold.
    void cylinder(double radius, double length)
    {
        SoftBodyDef def{.name = "cylinder"};
        std::vector<Vec3> line;
        for (int i = 0; i <= 16; ++i) line.push_back({0, 0, length * (i / 16.0 - 0.5)});
        const bool hollow = random_.chance(0.5);
        auto mesh = hollow ? geometry::shapes::vessel(line, 0.5 * radius, 0.5 * radius, {10, 2})
                           : geometry::shapes::block({1.4 * radius, 1.4 * radius, length}, {4, 4, 16});
        tissue_ = random_.logarithmic(2e3, 2e5);
        def.material = physics::FemMaterial{.youngModulus = tissue_};
        def.friction = friction_;
        def.collision = {{.proximity = 0.1 * radius}};
        std::map<long, std::vector<int>> sections; // by height
        physics::AttachmentDef ends;
        for (std::size_t i = 0; i < mesh->nodes.size(); ++i) {
            const double z = mesh->nodes[i].z;
            sections[std::lround(16.0 * z / length)].push_back(static_cast<int>(i));
            if (std::abs(z) > 0.499 * length) ends.nodes.push_back(static_cast<int>(i));
        }
        def.attachments = {ends};
        def.mesh = mesh;
        FuzzLine axis{.body = scene_.bodies.size()};
        for (const auto& [z, nodes] : sections) axis.sections.push_back(nodes);
        scene_.lines.push_back(axis);
        scene_.tissues.push_back(scene_.bodies.size());
        scene_.bodies.emplace_back(def);
    }
    /// All hands wait until then [s].
    void wait(double until)
    {
        for (FuzzHand& hand : scene_.hands) hand.until = until;
    }
    [[nodiscard]] std::size_t bodies() const { return scene_.bodies.size(); }
    /// A rigid rod along this axis, which moves as a hand does.
    void bar(Vec3 from, Vec3 to, double radius)
    {
        const Vec3 centre = 0.5 * (from + to), half = 0.5 * (to - from);
        RigidBodyDef def{.elements = {Pose{centre}}};
        def.name = "bar " + std::to_string(scene_.bodies.size() + 1);
        def.mesh = geometry::shapes::tube({-half, half}, radius, 12);
        def.collision = {{.proximity = 0.5 * radius_}};
        def.friction = friction_;
        FuzzHand mover{.body = scene_.bodies.size(), .home = centre, .reach = 0.5 * length(half), .turns = true};
        mover.now = Pose{centre};
        mover.target = centre;
        scene_.hands.push_back(mover);
        scene_.lines.push_back({.body = scene_.bodies.size(), .axis = {-half, half}});
        scene_.bodies.emplace_back(def);
    }
    void tissue(double size, double top)
    {
        SoftBodyDef def;
        def.name = "tissue";
        def.mesh = geometry::shapes::block({size, 0.3 * size, size}, {8, 3, 8});
        def.pose = Pose{{0, top - 0.15 * size, 0}};
        tissue_ = random_.logarithmic(2e3, 2e5);
        def.material = physics::FemMaterial{.youngModulus = tissue_};
        def.friction = friction_;
        def.collision = {{.proximity = 0.02 * size}};
        def.attachments = {{.box = geometry::Box{{-1, top - 1.0, -1}, {1, top - 0.299 * size, 1}}}};
        scene_.tissues.push_back(scene_.bodies.size());
        scene_.bodies.emplace_back(def);
    }

private:
    /// [N/m] A tool's springs, relative to a thread of 200 radii.
    double soft(double low, double high)
    {
        return random_.uniform(low, high) * modulus_ * std::numbers::pi * radius_ / 200.0;
    }
    std::size_t hand(Vec3 place, double reach)
    {
        RigidBodyDef def{.elements = {Pose{place}}};
        def.name = "hand " + std::to_string(scene_.bodies.size() + 1);
        FuzzHand hand{.body = scene_.bodies.size(), .home = place, .reach = reach};
        hand.now = Pose{place};
        hand.target = place;
        scene_.hands.push_back(hand);
        scene_.bodies.emplace_back(def);
        return hand.body;
    }

    FuzzRandom& random_;
    KnotScene& scene_;
    double radius_, modulus_, friction_, damping_, edge_;
    double tissue_ = 0.0; ///< [Pa] modulus of the tissue; 0: there is none
};

/// Threads one above the other, in any direction, held at both ends or at one.
void makeThreads(SceneMaker& make, FuzzRandom& random)
{
    const int count = 2 + random.below(2);
    for (int i = 0; i < count; ++i) {
        const double half = random.uniform(90.0, 130.0) * make.radius(), angle = random.uniform(0.0, std::numbers::pi);
        const Vec3 along{half * std::cos(angle), 0, half * std::sin(angle)}, up{0, 8.0 * i * make.radius(), 0};
        std::vector<double> held{0.0, 1.0};
        if (random.chance(0.3)) held.pop_back();
        make.thread({up - along, up + along}, held);
    }
}

/// A chain of rings, each through the one before.
void makeRings(SceneMaker& make, FuzzRandom& random)
{
    const int count = 2 + random.below(2);
    const double size = random.uniform(25.0, 40.0) * make.radius();
    for (int i = 0; i < count; ++i) {
        std::vector<Vec3> points;
        for (int k = 0; k < 40; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / 40, c = size * std::cos(angle),
                         s = size * std::sin(angle);
            points.push_back(Vec3{1.2 * i * size, 0, 0} + (i % 2 == 0 ? Vec3{c, s, 0} : Vec3{c, 0, s}));
        }
        std::vector<double> held{random.uniform(0, 1)};
        if (random.chance(0.5)) held.push_back(random.uniform(0, 1));
        make.thread(points, held, true);
    }
}

void makeOverhand(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius();
    OverhandKnotDef def{.turns = 1 + random.below(3), .pitch = 30.0 * r, .loop = 20.0 * r, .clearance = 3.0 * r};
    def.tail = 60.0 * r;
    make.thread(overhandKnot(def), {0.0, 1.0});
}

void makeSurgeon(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius();
    ThrowsDef def{.length = 28.0 * r, .rise = 8.0 * r, .clearance = 3.2 * r, .standing = 40.0 * r, .tail = 40.0 * r};
    def.turns = {1 + random.below(2)};
    for (int more = random.below(3); more > 0; --more) def.turns.push_back(1);
    const std::vector<Vec3> one = throwsLine(def);
    std::vector<Vec3> two;
    for (const Vec3 p : one) two.push_back(halfTurn(p));
    make.thread(one, {0.0, 1.0});
    make.thread(two, {0.0, 1.0});
}

/// Threads over a bar, or a needle, that moves as well. There is but one: between two there may be no room for a
/// thread.
void makeBars(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius(), thick = random.logarithmic(1.5, 15.0) * r, half = 100.0 * r;
    make.bar({0, 0, -half}, {0, 0, half}, thick);
    const int count = 1 + random.below(2);
    for (int i = 0; i < count; ++i) {
        const double z = 10.0 * i * r, y = thick + 4.0 * r;
        make.thread({{-half, y, z - 5.0 * r}, {half, y, z}}, {0.0, 1.0});
    }
}

void makeTissue(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius(), size = 150.0 * r;
    make.tissue(size, 0.0);
    const int count = 1 + random.below(2);
    for (int i = 0; i < count; ++i) {
        const double half = 100.0 * r, angle = random.uniform(0.0, std::numbers::pi);
        const Vec3 along{half * std::cos(angle), 0, half * std::sin(angle)}, up{0, (6.0 + 8.0 * i) * r, 0};
        make.thread({up - along, up + along}, {0.1, 0.9}); // a tip that is pressed into tissue pierces it
    }
}

/// A needle draws its thread past, around and between threads that hands hold.
void makeNeedleAmongThreads(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius(), arc = random.uniform(15.0, 40.0) * r, half = 100.0 * r;
    make.needle({0, 0.5 * arc, 0}, arc, random.uniform(1.0, 2.0) * r,
                {{-20.0 * r, 10.0 * r, 0}, {-40.0 * r, 0, 20.0 * r}, {-120.0 * r, 0, 40.0 * r}});
    const int count = 1 + random.below(2);
    for (int i = 0; i < count; ++i) { // under the arc, through it
        const double y = (0.2 + 0.5 * i) * arc, lean = random.uniform(-20.0, 20.0) * r;
        make.thread({{lean, y, -half}, {-lean, y, half}}, {0.0, 1.0});
    }
}

/// Jaws hold a thread, or slip along it, and draw it about; another thread lies across it.
void makeJawsOnThreads(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius(), half = random.uniform(80.0, 120.0) * r;
    const std::size_t before = make.bodies();
    const std::vector<double> held = random.chance(0.5) ? std::vector<double>{0.0, 1.0} : std::vector<double>{0.0};
    make.thread({{-half, 0, 0}, {half, 0, 0}}, held);
    const std::size_t thread = before + held.size();
    if (random.chance(0.7)) make.thread({{40.0 * r, 4.0 * r, -half}, {40.0 * r, 4.0 * r, half}}, {0.0, 1.0});
    make.jaws({random.uniform(-20.0, 20.0) * r, 0, 0}, thread);
    make.wait(2.0 * kCloses);
}

/// A ring, or a thread that winds one and a half times, around a soft cylinder.
void makeAround(SceneMaker& make, FuzzRandom& random)
{
    const double r = make.radius(), radius = random.uniform(15.0, 40.0) * r, wide = radius + 5.0 * r;
    make.cylinder(radius, 400.0 * r);
    std::vector<Vec3> points;
    if (random.chance(0.5)) {
        for (int k = 0; k < 32; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / 32;
            points.push_back({wide * std::cos(angle), wide * std::sin(angle), 0.0});
        }
        make.thread(points, random.chance(0.5) ? std::vector<double>{0.0} : std::vector<double>{0.0, 0.5}, true);
        return;
    }
    points.push_back({wide, -60.0 * r, -20.0 * r});
    for (int k = 0; k <= 36; ++k) {
        const double angle = 3.0 * std::numbers::pi * k / 36;
        points.push_back({wide * std::cos(angle), wide * std::sin(angle), (k - 18) / 18.0 * 12.0 * r});
    }
    points.push_back({-wide, -60.0 * r, 20.0 * r});
    make.thread(points, {0.0, 1.0});
}

} // namespace

const char* name(KnotKind kind)
{
    constexpr std::array names{"threads", "rings",  "overhand knot", "knot of throws", "bars",
                               "tissue",  "needle", "jaws",          "around tissue"};
    static_assert(names.size() == static_cast<std::size_t>(KnotKind::count_));
    return names[static_cast<std::size_t>(kind)];
}

void FuzzHand::move(double time, double dt, FuzzRandom& random)
{
    if (time >= until) {
        speed = random.chance(0.2) ? 0.0 : random.logarithmic(0.02, 1.0);
        target = home + random.uniform(0.0, reach) * random.direction();
        axis = random.direction();
        until = time + random.uniform(0.05, 0.4);
    }
    const Vec3 way = target - now.position;
    const double left = length(way), step = std::min(left, speed * dt);
    if (left > 0.0) now.position += step / left * way;
    // A point at the end of a bar turns no faster than the hand moves.
    if (turns && step > 0.0) now.orientation = normalized(axisAngle(axis, 0.5 * step / reach) * now.orientation);
}

Pose FuzzHand::jaw(int which, double time) const
{
    const double part = std::clamp(time / kCloses, 0.0, 1.0), apart = opens + part * (closed - opens);
    return now * Pose{{0, (which == 0 ? 0.5 : -0.5) * apart, 0}};
}

KnotScene knotScene(KnotKind kind, FuzzRandom& random)
{
    KnotScene scene;
    SceneMaker make(random, scene);
    switch (kind) {
    case KnotKind::Threads:
        makeThreads(make, random);
        break;
    case KnotKind::Rings:
        makeRings(make, random);
        break;
    case KnotKind::Overhand:
        makeOverhand(make, random);
        break;
    case KnotKind::Surgeon:
        makeSurgeon(make, random);
        break;
    case KnotKind::Bars:
        makeBars(make, random);
        break;
    case KnotKind::Tissue:
        makeTissue(make, random);
        break;
    case KnotKind::Needle:
        makeNeedleAmongThreads(make, random);
        break;
    case KnotKind::Jaws:
        makeJawsOnThreads(make, random);
        break;
    case KnotKind::Around:
        makeAround(make, random);
        break;
    case KnotKind::count_:
        break;
    }
    return scene;
}

} // namespace filasofia::testing
