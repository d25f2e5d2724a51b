#include "apps/hysteroscopy/expert.h"

using namespace filasofia;

namespace hysteroscopy {
namespace {

constexpr Vec3 kUp = {0, 0, 1}; ///< anterior: the upper side of the picture where nothing is rolled
constexpr double kOut = 8_mm;   ///< reach of forceps that are free to open
const Pose kChannel = prefab::EndoscopeDef{}.channel;

Pose tipOf(const Hand& hand)
{
    const Vec3 tip = kFulcrum + hand.depth * hand.aim;
    return lookAt(tip, tip + hand.aim, kUp) * Pose{{}, axisAngle({0, 0, 1}, hand.roll)};
}

/// The hand whose jaws have `target` between them: the channel lies beside the axis that goes through the fulcrum.
Hand handAt(Vec3 target, double roll)
{
    Hand hand{.roll = roll, .reach = kOut};
    for (int i = 0; i < 5; ++i) { // the offset turns with the direction: converges at once
        const Vec3 offset = rotate(tipOf(hand).orientation, {kChannel.position.x, kChannel.position.y, 0});
        hand.aim = normalized(target - offset - kFulcrum);
        hand.depth = distance(target - offset, kFulcrum) - kOut + kChannel.position.z - 3_mm;
    }
    return hand;
}

/// Jaws open up and down in the scope's picture. They take the polyp from its sides: so that neither of them has to get
/// between it and its wall, they open across its stalk.
double rollFor(const Patient& patient)
{
    const Hand straight = handAt(patient.middle, 0.0);
    const Vec3 stalk = rotate(conjugate(tipOf(straight).orientation), patient.site.normal);
    if (std::hypot(stalk.x, stalk.y) < 0.4) return 0.0; // it grows towards the scope
    const double roll = std::atan2(stalk.y, stalk.x);   // +X along the stalk, +Y across
    return roll > 90_deg ? roll - 180_deg : roll < -90_deg ? roll + 180_deg : roll;
}

double smooth(double t) { return t * t * (3.0 - 2.0 * t); }

Hand between(const Hand& a, const Hand& b, double t)
{
    const auto mix = [t](double from, double to) { return from + t * (to - from); };
    return {normalized(a.aim + t * (b.aim - a.aim)), mix(a.depth, b.depth), mix(a.roll, b.roll), mix(a.reach, b.reach)};
}

} // namespace

void apply(const Hand& hand, prefab::Endoscope& scope, prefab::ArticulatedInstrument& forceps)
{
    scope.move(tipOf(hand));
    forceps.move(scope.channel() * Pose{{0, 0, -hand.reach}, {}});
}

std::vector<Move> expertMotion(const Patient& patient)
{
    const auto straight = [](double y) { return Hand{.depth = y - kFulcrum.y}; };
    Hand grasp = handAt(patient.middle, rollFor(patient));
    Hand before = grasp;
    before.depth -= 7_mm;
    Hand sheathed = before;
    sheathed.reach = -6_mm;
    Hand pulled = grasp;
    pulled.depth -= 12_mm;
    Hand out = straight(-25_mm);
    out.reach = kOut;
    const Hand inside = straight(33_mm);
    Hand left = inside, right = inside;
    left.roll = 50_deg;
    right.roll = -50_deg;
    return {{.seconds = 0.4, .to = straight(-9_mm), .picture = "os"},
            {.seconds = 1.4, .to = straight(12_mm), .picture = "canal"},
            {.seconds = 1.6, .to = inside, .picture = "cavity"},
            {.seconds = 0.5, .to = left},
            {.seconds = 0.8, .to = right},
            {.seconds = 1.0, .to = sheathed, .picture = "polyp"},
            {.seconds = 0.5, .to = before},
            {.seconds = 0.6, .to = before, .jaws = Jaws::Open},
            {.seconds = 0.8, .to = grasp},
            {.seconds = 0.9, .to = grasp, .jaws = Jaws::Close, .picture = "grasped"},
            {.seconds = 1.6, .to = pulled, .picture = "torn"},
            {.seconds = 2.2, .to = out}};
}

double durationOf(const std::vector<Move>& moves)
{
    double sum = 0.0;
    for (const Move& move : moves) sum += move.seconds;
    return sum;
}

Moment at(const std::vector<Move>& moves, double time)
{
    Hand from;
    for (std::size_t i = 0; i < moves.size(); ++i) {
        if (time < moves[i].seconds)
            return {between(from, moves[i].to, smooth(std::max(0.0, time / moves[i].seconds))), i};
        time -= moves[i].seconds;
        from = moves[i].to;
    }
    return {from, moves.size()};
}

} // namespace hysteroscopy
