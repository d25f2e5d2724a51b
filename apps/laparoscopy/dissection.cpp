#include "apps/laparoscopy/gallbladder.h"

#include <filasofia/core/random.h>

#include <cmath>
#include <numbers>

using namespace filasofia;

namespace operation {
namespace {

constexpr Vec3 kGrip = {0, 0, -15.5_mm}, kHook = {0, 0, -13.5_mm}, kClip = {0, 0, -9_mm}, kBlades = {0, 0, -12_mm},
               kMouth = {0, 0, -37_mm};
constexpr Vec3 kBagAt = {-15_mm, 15_mm, 38_mm}; // the middle of its mouth

/// What a motion remembers from move to move.
struct Plan {
    GallbladderMotion with;
    TrocarPoses goal = {};
    std::vector<TrocarMove> moves = {};

    [[nodiscard]] FrameRef now() const { return with.sim.physics().latest(); }
    [[nodiscard]] Vec3 middle() const ///< [m], the mean of the gall bladder's nodes
    {
        Vec3 sum;
        const auto& nodes = now()->softBody(with.patient.gallbladder)->positions;
        for (const Vec3& each : nodes) sum += 1.0 / static_cast<double>(nodes.size()) * each;
        return sum;
    }
    [[nodiscard]] Vec3 node(int index) const
    {
        return now()->softBody(with.patient.gallbladder)->positions[static_cast<std::size_t>(index)];
    }
};
using Shared = std::shared_ptr<Plan>;
using Aim = std::function<TrocarPose()>;

void add(const Shared& plan, double seconds, const Aim& left, const Aim& right, std::function<void()> begin = {},
         std::function<void()> end = {})
{
    plan->moves.push_back({.seconds = seconds,
                           .aim =
                               [plan, left, right] {
                                   if (left) plan->goal.left = left();
                                   if (right) plan->goal.right = right();
                                   return plan->goal;
                               },
                           .begin = std::move(begin),
                           .end = std::move(end)});
}
void rest(const Shared& plan, double seconds, std::function<void()> begin = {}, std::function<void()> end = {})
{
    add(plan, seconds, {}, {}, std::move(begin), std::move(end));
}
/// Closes or opens the jaws of the right hand's tool; presses or releases the hook's pedal.
auto press(const Shared& plan, bool on)
{
    return [plan, on] {
        ArticulatedInstrument& jaws = plan->with.tools.right[Hook]->tool();
        on ? jaws.close() : jaws.open();
    };
}
/// Draws the right tool back, and takes another one.
void take(const Shared& plan, InHand tool)
{
    const auto out = [plan] {
        TrocarPose pose = plan->goal.right;
        pose.insertion = std::max(0.08, pose.insertion - 60_mm);
        return pose;
    };
    add(plan, 0.3, {}, out, press(plan, false));
    rest(plan, 0.35, [plan, tool] { plan->with.tools.choose(tool); });
}

Aim hookAt(const Shared& plan, std::function<Vec3()> place, double back = 0.0)
{
    return [plan, place = std::move(place), back] {
        return reach(*plan->with.tools.right[Hook], place(), kHook, {0, 1, 0}, back);
    };
}
/// Moves the neck of the gall bladder by this much from where it is held now.
Aim draw(const Shared& plan, Vec3 by)
{
    return [plan, by] {
        const Vec3 grip = transform(plan->with.tools.left.report().pivot, kGrip);
        TrocarPose pose = poseAt(plan->with.tools.left.def().trocar, grip + by, plan->goal.left.roll, kGrip);
        return withinLimits(plan->with.tools.left.def().trocar, pose);
    };
}

void addGrasp(const Shared& plan)
{
    const auto at = [plan](double back) {
        return [plan, back] {
            const GallbladderPatient& patient = plan->with.patient;
            const Vec3 neck = patient.duct.at(plan->now(), 0.0);
            Vec3 middle; // the middle of its bed
            for (const int node : patient.bed[1])
                middle += 1.0 / static_cast<double>(patient.bed[1].size()) * plan->node(node);
            Vec3 axis = middle - neck;
            axis.z = 0.0;
            axis = normalized(axis);
            const Vec3 across = cross(axis, {0, 0, 1});
            return reach(plan->with.tools.left, neck + 9.5_mm * axis, kGrip, across, back);
        };
    };
    rest(plan, 1.5); // an assistant lifts the fundus
    add(plan, 0.8, at(30_mm), {});
    add(plan, 0.7, at(1_mm), {});
    rest(
        plan, 0.5, [plan] { plan->with.tools.left.tool().close(); }, plan->with.picture("grasped"));
    add(plan, 1.1, draw(plan, {-7_mm, -5_mm, 5_mm}), {});
}

/// The hook goes through the layer between artery and duct, towards the gall bladder.
void addTriangle(const Shared& plan)
{
    const auto at = [plan](double part) {
        return [plan, part] {
            const FrameRef now = plan->now();
            return 0.5 * (plan->with.patient.artery.at(now, part) + plan->with.patient.duct.at(now, part)) +
                   Vec3{0, 0, -0.5_mm};
        };
    };
    add(plan, 0.6, {}, hookAt(plan, at(0.95), 25_mm));
    add(plan, 0.5, {}, hookAt(plan, at(0.95)));
    rest(plan, 0.05, press(plan, true));
    for (int i = 1; i <= 10; ++i) add(plan, 0.25, {}, hookAt(plan, at(0.95 - 0.088 * i)));
    rest(plan, 0.05, press(plan, false), plan->with.picture("triangle"));
}

/// The hook passes along the nodes of a part of the bed, from the neck on, to and fro across it.
void addBed(const Shared& plan, std::size_t part, double seconds)
{
    std::vector<int> nodes = plan->with.patient.bed[part];
    const auto mesh =
        physics::worldMesh(std::get<SoftBodyDef>(*plan->with.sim.physics().def(plan->with.patient.gallbladder)));
    const auto along = [&](int node) { // from the neck to the fundus, in rows
        const Vec3 p = mesh.nodes[static_cast<std::size_t>(node)];
        return std::floor((-0.725 * p.x + 0.689 * p.y) / 4_mm);
    };
    const auto key = [&](int node) {
        const Vec3 p = mesh.nodes[static_cast<std::size_t>(node)];
        const double across = 0.689 * p.x + 0.725 * p.y;
        return std::pair(along(node), static_cast<int>(along(node)) % 2 == 0 ? across : -across);
    };
    std::ranges::sort(nodes, {}, key);
    const auto over = [plan](int node) { return [plan, node] { return plan->node(node) + Vec3{0, 0, 0.4_mm}; }; };
    add(plan, 0.5, {}, hookAt(plan, over(nodes.front()), 20_mm));
    add(plan, 0.3, {}, hookAt(plan, over(nodes.front())));
    rest(plan, 0.05, press(plan, true));
    for (const int node : nodes) add(plan, seconds, {}, hookAt(plan, over(node)));
    rest(plan, 0.05, press(plan, false));
}

Aim onTube(const Shared& plan, InHand tool, bool duct, double part, double back)
{
    return [plan, tool, duct, part, back] {
        const PatientTube& tube = duct ? plan->with.patient.duct : plan->with.patient.artery;
        const FrameRef now = plan->now();
        const LaparoscopicInstrument& with = *plan->with.tools.right[tool];
        const Vec3 place = tube.at(now, part);
        const Vec3 across = cross(tube.along_(now, part), place - with.def().trocar.fulcrum);
        return reach(with, place, tool == Applier ? kClip : kBlades, across, back);
    };
}
void addClosing(const Shared& plan, InHand tool, bool duct, double part)
{
    add(plan, 0.5, {}, onTube(plan, tool, duct, part, 14_mm));
    add(plan, 0.4, {}, onTube(plan, tool, duct, part, 0.0));
    rest(plan, 0.6, press(plan, true));
    rest(plan, 0.15, press(plan, false));
    add(plan, 0.3, {}, onTube(plan, tool, duct, part, 14_mm));
}

/// Turns the grasper until the gall bladder hangs down from it.
Aim hang(const Shared& plan)
{
    return [plan] {
        const Pose pivot = plan->with.tools.left.report().pivot;
        const auto angle = [&](Vec3 direction) {
            const Vec3 seen = rotate(conjugate(pivot.orientation), direction);
            return std::atan2(seen.y, seen.x);
        };
        TrocarPose pose = plan->goal.left;
        const double turn = angle({0, -1, 0}) - angle(plan->middle() - transform(pivot, kGrip));
        pose.roll += std::remainder(turn, 2.0 * std::numbers::pi);
        return pose;
    };
}

/// Moves the gall bladder over the mouth of the bag: its lowest point `above` [m] the mouth, or its highest if `in`.
Aim over(const Shared& plan, double above, bool in = false)
{
    return [plan, above, in] {
        const auto& nodes = plan->now()->softBody(plan->with.patient.gallbladder)->positions;
        const auto [low, high] = std::ranges::minmax(nodes, {}, &Vec3::y);
        Vec3 by = kBagAt - plan->middle();
        by.y = kBagAt.y + above - (in ? high.y : low.y);
        return draw(plan, by)();
    };
}

/// The bag comes in; the gall bladder is lowered into it and let go; closed, the bag goes back to its port with it.
void addRetrieval(const Shared& plan)
{
    const auto bag = [plan](double back) -> Aim {
        return [plan, back] { return reach(*plan->with.tools.right[Bag], kBagAt, kMouth, {0, 1, 0}, back); };
    };
    const auto back = [plan] {
        TrocarPose pose = plan->goal.right;
        pose.insertion = 65_mm;
        return pose;
    };
    add(plan, 1.5, hang(plan), [plan] {
        const TrocarDef& scope = plan->with.tools.scope.def().trocar;
        plan->goal.scope = poseAt(scope, kBagAt + Vec3{0, -25_mm, 0});
        plan->goal.scope.insertion = 8_mm;
        return plan->goal.right;
    });
    add(plan, 1.5, over(plan, 25_mm), {});
    take(plan, Bag);
    add(plan, 0.8, over(plan, 15_mm), bag(45_mm));
    add(plan, 0.6, {}, bag(0.0));
    rest(plan, 0.3, {}, plan->with.picture("bag"));
    add(plan, 2.0, over(plan, -5_mm, true), {});
    rest(plan, 0.4, [plan] { plan->with.tools.left.tool().open(0.55); });
    add(plan, 0.8, draw(plan, {-15_mm, 50_mm, 0}), {}, {}, plan->with.picture("bagged"));
    rest(plan, 0.8, press(plan, true), plan->with.picture("closed"));
    add(plan, 2.0, {}, back);
    rest(plan, 0.5);
}

Shared planOf(const GallbladderMotion& with)
{
    const GallbladderTools& tools = with.tools;
    return std::make_shared<Plan>(
        Plan{with, {tools.left.def().start, tools.right[Hook]->def().start, tools.scope.def().start}});
}

} // namespace

std::vector<TrocarMove> expertMotion(const GallbladderMotion& with)
{
    const Shared plan = planOf(with);
    addGrasp(plan);
    addTriangle(plan);
    addBed(plan, 0, 0.14);
    rest(plan, 0.1, {}, with.picture("view"));
    take(plan, Applier);
    for (const bool duct : {true, false})
        for (const double part : {0.80, 0.68, 0.38}) addClosing(plan, Applier, duct, part);
    take(plan, Scissors);
    rest(plan, 0.1, {}, with.picture("clipped"));
    for (const bool duct : {true, false}) addClosing(plan, Scissors, duct, 0.53);
    rest(plan, 0.1, {}, with.picture("cut"));
    take(plan, Hook);
    add(plan, 1.2, draw(plan, {-4_mm, 18_mm, 20_mm}), {});
    addBed(plan, 1, 0.14);
    add(
        plan, 0.4, {}, [plan] { return plan->with.tools.right[Hook]->def().start; }, {}, with.picture("detached"));
    add(plan, 1.5, draw(plan, {-20_mm, 10_mm, 30_mm}), {});
    rest(plan, 0.4);
    addRetrieval(plan);
    return std::move(plan->moves);
}

std::vector<TrocarMove> clumsyMotion(const GallbladderMotion& with, std::uint64_t seed)
{
    const Shared plan = planOf(with);
    Random random(seed);
    addGrasp(plan);
    for (int i = 0; i < 8; ++i) {
        const auto tool = static_cast<InHand>(random.below(3));
        const bool duct = random.onceIn(2);
        const double part = random.between(0.1, 0.9);
        const Vec3 off = {random.between(-4_mm, 4_mm), random.between(-4_mm, 4_mm), random.between(-5_mm, 3_mm)};
        const auto near = [=](double back) {
            return [=] {
                const PatientTube& tube = duct ? plan->with.patient.duct : plan->with.patient.artery;
                const Vec3 place = tube.at(plan->now(), part) + off;
                return reach(*plan->with.tools.right[tool], place, tool == Hook ? kHook : kBlades, {0, 1, 0}, back);
            };
        };
        take(plan, tool);
        add(plan, random.between(0.3, 0.6), {}, near(15_mm));
        add(plan, random.between(0.2, 0.4), {}, near(0.0));
        rest(plan, random.between(0.2, 0.5), press(plan, true));
        const Vec3 pull = {random.between(-12_mm, 12_mm), random.between(-12_mm, 12_mm), random.between(-4_mm, 14_mm)};
        add(plan, random.between(0.3, 0.8), random.onceIn(2) ? draw(plan, pull) : Aim(),
            near(random.between(-3_mm, 6_mm)));
        rest(plan, 0.2, press(plan, false));
    }
    return std::move(plan->moves);
}

} // namespace operation
