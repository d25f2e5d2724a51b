#include "apps/laparoscopy/motion.h"

#include <filasofia/core/random.h>

using namespace filasofia;

namespace laparoscopy {
namespace {

constexpr Vec3 kGrip = {0, 0, -19_mm}; ///< where the jaws take a wall, from their pivot
constexpr double kOpen = 0.35;         ///< so that one jaw fits between ring and peg
constexpr Vec3 kMeeting = {0, 46_mm, 4_mm};

/// What a motion remembers from move to move; its functions share it.
struct Plan {
    Motion with;
    TrocarPoses goal = {};

    TrocarPose& of(Side side) { return side == LeftSide ? goal.left : goal.right; }
    [[nodiscard]] LaparoscopicInstrument& tool(Side side) const { return *with.tools[side]; }
    [[nodiscard]] const TrocarDef& trocar(Side side) const { return tool(side).def().trocar; }
    [[nodiscard]] Pose ring(int index) const
    {
        return with.sim.physics().latest()->rigidBody(with.box.rings[static_cast<std::size_t>(index)])->poses[0];
    }
    [[nodiscard]] bool holds(Side side, int index) const
    {
        return tool(side).tool().holding() == with.box.rings[static_cast<std::size_t>(index)];
    }
};
using Shared = std::shared_ptr<Plan>;
constexpr Side other(Side side) { return side == LeftSide ? RightSide : LeftSide; }

/// Takes the wall of a ring on the hand's own side, where it runs along the shaft. `back` is the distance along the
/// shaft that is left, `above` a lift of the grip.
TrocarPose atWall(Plan& plan, Side side, int index, double back, double above = 1.2_mm)
{
    const Pose ring = plan.ring(index);
    const Vec3 up = rotate(ring.orientation, {0, 1, 0});
    Vec3 wall = ring.position, across;
    for (int i = 0; i < 4; ++i) { // the shaft's direction depends on the place
        across = normalized(cross(wall - plan.trocar(side).fulcrum, up));
        if ((across.x < 0.0) != (side == LeftSide)) across = -across;
        wall = ring.position + kRingRadius * across + above * up;
    }
    TrocarPose pose = poseAt(plan.trocar(side), wall, rollAcross(plan.trocar(side), wall, across), kGrip);
    pose.insertion -= back;
    return pose;
}

/// Brings the middle of a held ring to a place.
TrocarPose carry(Plan& plan, Side side, int index, Vec3 to)
{
    const Vec3 held = transform(inverse(plan.tool(side).report().pivot), plan.ring(index).position);
    return poseAt(plan.trocar(side), to, plan.of(side).roll, held);
}

/// A move in which one hand goes where `where` says when it begins.
TrocarMove move(const Shared& plan, Side side, double seconds, std::function<TrocarPose()> where)
{
    return {.seconds = seconds, .aim = [plan, side, where = std::move(where)] {
                plan->of(side) = withinLimits(plan->trocar(side), where());
                return plan->goal;
            }};
}
TrocarMove rest(const Shared& plan, double seconds)
{
    return {.seconds = seconds, .aim = [plan] { return plan->goal; }};
}
TrocarMove with(TrocarMove move, std::function<void()> begin, std::function<bool()> skip = {},
                std::function<void()> end = {})
{
    move.begin = std::move(begin);
    move.skip = std::move(skip);
    move.end = std::move(end);
    return move;
}

auto open(const Shared& plan, Side side)
{
    return [=] { plan->tool(side).tool().open(kOpen); };
}
auto shut(const Shared& plan, Side side)
{
    return [=] { plan->tool(side).tool().close(); };
}

/// Up to three attempts to take a ring, each a little deeper.
void addTake(std::vector<TrocarMove>& moves, const Shared& plan, Side side, int ring, const std::function<void()>& held)
{
    const auto has = [plan, side, ring] { return plan->holds(side, ring); };
    for (const double above : {1.2_mm, 0.4_mm, 2_mm}) {
        const auto at = [plan, side, ring, above](double back) {
            return [plan, side, ring, above, back] { return atWall(*plan, side, ring, back, above); };
        };
        moves.push_back(with(move(plan, side, 0.7, at(26_mm)), open(plan, side), has));
        moves.push_back(with(move(plan, side, 0.5, at(0.0)), {}, has));
        moves.push_back(with(rest(plan, 0.45), shut(plan, side), has, held));
    }
}

void addTransfer(std::vector<TrocarMove>& moves, const Shared& plan, Side from, int ring, int peg)
{
    const Side to = other(from);
    const bool first = moves.size() == 1;
    const auto picture = [&](const char* name) { return first ? plan->with.picture(name) : std::function<void()>(); };
    const auto lifted = [=] {
        const Vec3 at = plan->ring(ring).position;
        return carry(*plan, from, ring, {at.x, kPegHeight + 12_mm, at.z});
    };
    const auto place = [plan, ring, to, peg](double height) {
        return [=] { return carry(*plan, to, ring, pegAt(to, peg) + Vec3{0, height, 0}); };
    };
    const auto away = [plan](Side side) {
        return [=] {
            TrocarPose pose = plan->of(side);
            pose.insertion -= 32_mm;
            return pose;
        };
    };
    addTake(moves, plan, from, ring, picture("taken"));
    moves.push_back(move(plan, from, 0.5, lifted));
    moves.push_back(move(plan, from, 0.8, [=] { return carry(*plan, from, ring, kMeeting); }));
    addTake(moves, plan, to, ring, picture("given"));
    moves.push_back(with(rest(plan, 0.15), open(plan, from)));
    moves.push_back(move(plan, from, 0.35, away(from)));
    moves.push_back(with(move(plan, to, 0.9, place(kPegHeight + 9_mm)), {}, {}, picture("over")));
    moves.push_back(move(plan, to, 0.6, place(6.5_mm)));
    moves.push_back(with(rest(plan, 0.2), open(plan, to)));
    moves.push_back(with(move(plan, to, 0.4, away(to)), {}, {}, picture("placed")));
}

Shared planOf(const Motion& with)
{
    return std::make_shared<Plan>(
        Plan{with, {with.tools[LeftSide]->def().start, with.tools[RightSide]->def().start, scopeOf().start}});
}

} // namespace

std::vector<TrocarMove> expertMotion(const Motion& with)
{
    const Shared plan = planOf(with);
    const int rings = static_cast<int>(with.box.rings.size());
    std::vector<TrocarMove> moves = {rest(plan, 0.2)}; // the rings come to rest
    for (int ring = 0; ring < rings; ++ring) addTransfer(moves, plan, LeftSide, ring, ring);
    for (int ring = 0; with.back && ring < rings; ++ring) addTransfer(moves, plan, RightSide, ring, ring);
    return moves;
}

std::vector<TrocarMove> clumsyMotion(const Motion& motion, std::uint64_t seed)
{
    const Shared plan = planOf(motion);
    Random random(seed);
    std::vector<TrocarMove> moves = {rest(plan, 0.2)}; // the rings come to rest
    for (int i = 0; i < 10; ++i) {
        const Side side = random.onceIn(3) ? RightSide : LeftSide;
        const int ring = random.below(static_cast<int>(motion.box.rings.size()));
        const Vec3 off = {random.between(-3_mm, 3_mm), random.between(-4_mm, 2_mm), random.between(-3_mm, 3_mm)};
        const auto near = [=](double back) {
            return [=] {
                TrocarPose pose = atWall(*plan, side, ring, back);
                const Vec3 at = transform(pivotOf(plan->trocar(side), pose), kGrip) + off;
                return poseAt(plan->trocar(side), at, pose.roll, kGrip);
            };
        };
        const Vec3 astray = {random.between(-60_mm, 60_mm), random.between(-4_mm, 70_mm),
                             random.between(-40_mm, 40_mm)};
        const double roll = random.between(-90_deg, 90_deg);
        moves.push_back(with(move(plan, side, random.between(0.3, 0.6), near(20_mm)), open(plan, side)));
        moves.push_back(move(plan, side, random.between(0.2, 0.5), near(0.0)));
        moves.push_back(with(rest(plan, random.between(0.2, 0.5)), shut(plan, side)));
        moves.push_back(move(plan, side, random.between(0.3, 0.7),
                             [=] { return poseAt(plan->trocar(side), astray, roll, kGrip); }));
        if (!random.onceIn(3)) moves.push_back(with(rest(plan, random.between(0.1, 0.3)), open(plan, side)));
    }
    return moves;
}

} // namespace laparoscopy
