#include "apps/laparoscopy/drain.h"

#include <filasofia/core/random.h>

#include <numbers>
#include <utility>

using namespace filasofia;

namespace suturing {
namespace {

constexpr Vec3 kGrip = {0, 0, -11_mm}; // where the jaws take the needle, from their pivot

/// The middle of the arc that leads through both marks, a little higher.
Vec3 middleOf(const Motion& with, double higher)
{
    const FrameRef now = with.sim.physics().latest();
    const Vec3 left = with.drain.mark(*now, LeftWall), right = with.drain.mark(*now, RightWall);
    const Vec3 up =
        rotate(pivotOf(with.right.def().trocar, poseAt(with.right.def().trocar, left)).orientation, {0, 1, 0});
    const double half = 0.5 * distance(left, right);
    return 0.5 * (left + right) + (std::sqrt(kRadius * kRadius - half * half) + higher) * up;
}

/// The jaws at the needle, so far behind its tip; `back` [m] is left along the shaft.
TrocarAim atNeedle(const Motion& with, double behind, double back)
{
    return [with, behind, back] {
        const FrameRef now = with.sim.physics().latest();
        return reach(with.right, with.drain.onNeedle(*now, behind), kGrip, with.drain.inward(*now, behind), back);
    };
}

/// The held needle with its tip at an angle of its arc, whose middle is brought so much above that of the stitch; none:
/// it stays where it is.
TrocarAim needleAt(const Motion& with, double angle, std::optional<double> higher)
{
    return [with, angle, higher] {
        const TrocarReport report = with.right.report();
        const Pose needle = with.sim.physics().latest()->rigidBody(with.drain.needle)->poses[0],
                   back = inverse(report.pivot);
        const Vec3 tip = rotate(back.orientation, rotate(needle.orientation, {1, 0, 0}));
        const double turn = std::remainder(angle - std::atan2(tip.y, tip.x) - report.pose.roll, 2.0 * std::numbers::pi);
        return poseAt(with.right.def().trocar, higher ? middleOf(with, *higher) : needle.position,
                      report.pose.roll + turn, transform(back, needle.position));
    };
}

/// The right hand from where it is, in the drain's coordinates.
TrocarAim onwards(const Motion& with, Vec3 by)
{
    return [with, by] {
        const TrocarReport report = with.right.report();
        const Vec3 grip = transform(report.pivot, kGrip) + rotate(with.drain.pose.orientation, by);
        return poseAt(with.right.def().trocar, grip, report.pose.roll, kGrip);
    };
}

/// The right hand from where it is, along its shaft.
TrocarAim backwards(const Motion& with, double by)
{
    return [&right = with.right, by] {
        TrocarPose pose = right.report().pose;
        pose.insertion -= by;
        return pose;
    };
}

void addTake(const Motion& with, TrocarPlan& plan, double behind)
{
    plan.add(0.8, {}, atNeedle(with, behind, 22_mm)).begin = [&right = with.right] { right.tool().open(0.5); };
    plan.add(0.6, {}, atNeedle(with, behind, 0.0));
    plan.rest(0.5).begin = [&right = with.right] { right.tool().close(); };
}
void addLetGo(const Motion& with, TrocarPlan& plan)
{
    plan.rest(0.3).begin = [&right = with.right] { right.tool().open(0.4); };
    plan.add(0.4, {}, backwards(with, 22_mm));
}
/// Turns the needle on about the middle of its arc.
void addTurn(const Motion& with, TrocarPlan& plan, double from, double to, bool centred)
{
    constexpr double kStep = 5_deg, kSpeed = 70_deg; // per second
    for (double angle = from; angle > to;) {
        const double before = std::exchange(angle, std::max(angle - kStep, to));
        plan.add((before - angle) / kSpeed, {}, needleAt(with, angle, centred ? std::optional(0.0) : std::nullopt));
    }
}

} // namespace

TrocarPlan expertMotion(const Motion& with)
{
    TrocarPlan plan(with.left, with.right, with.scope);
    plan.rest(0.3);
    addTake(with, plan, 185_deg);
    plan.rest(0.1).end = with.picture("held");
    plan.add(1.2, {}, needleAt(with, -25_deg, 14_mm));
    plan.add(0.8, {}, needleAt(with, -25_deg, 0.0));
    addTurn(with, plan, -25_deg, -185_deg, true);
    plan.rest(0.1).end = with.picture("through");
    addLetGo(with, plan);
    addTake(with, plan, 12_deg);
    addTurn(with, plan, -185_deg, -350_deg, false);
    plan.add(0.5, {}, onwards(with, {0, 14_mm, 0}));
    for (int i = 0; i < 30; ++i) plan.add(0.08, {}, onwards(with, {-4_mm, 1_mm, 0})).skip = with.drawn;
    plan.rest(0.1).end = with.picture("drawn");
    plan.add(0.8, {}, backwards(with, 90_mm));
    for (int i = 0; i < 15; ++i) plan.rest(0.1).skip = with.clear;
    plan.rest(2.0).end = with.picture("tying");
    for (int i = 0; i < 160; ++i) plan.rest(0.1).skip = with.tied;
    plan.rest(0.6).end = with.picture("tied");
    plan.rest(1.4); // while it is loaded
    return plan;
}

TrocarPlan clumsyMotion(const Motion& with, std::uint64_t seed)
{
    Random random(seed);
    TrocarPlan plan(with.left, with.right, with.scope);
    plan.rest(0.3);
    for (int i = 0; i < 3; ++i) {
        addTake(with, plan, random.between(0.0, kArc));
        double angle = random.between(-60_deg, 0.0);
        plan.add(random.between(0.5, 1.2), {}, needleAt(with, angle, random.between(4_mm, 14_mm)));
        const int strokes = 4 + random.below(6);
        for (int k = 0; k < strokes; ++k) {
            angle -= random.between(-10_deg, 40_deg);
            plan.add(random.between(0.1, 0.5), {}, needleAt(with, angle, random.between(-3_mm, 6_mm)));
        }
        plan.add(
            random.between(0.2, 0.6), {},
            onwards(with, {random.between(-20_mm, 20_mm), random.between(0.0, 25_mm), random.between(-10_mm, 10_mm)}));
        addLetGo(with, plan);
    }
    return plan;
}

} // namespace suturing
