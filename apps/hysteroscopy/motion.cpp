#include "apps/hysteroscopy/motion.h"

#include <filasofia/core/random.h>

using namespace filasofia;

namespace hysteroscopy {
namespace {

/// A pose straight in the canal with the tip at height `y`.
ScopeHand axial(double y, double roll = 0.0, double reach = -6_mm) { return {{0, 1, 0}, y - kFulcrum.y, roll, reach}; }

/// Tissue yields, so before every move the polyp's position is looked up again.
std::function<ScopeHand()> before(const Motion& with, double away, double roll, double sheathed = 0.0)
{
    return [&hands = with.hands, middle = with.middle, away, roll, sheathed] {
        ScopeHand hand = hands.at(middle(), away, roll, 8_mm);
        hand.reach -= sheathed;
        return hand;
    };
}

} // namespace

std::vector<HandMove> expertMotion(const Motion& with)
{
    const double roll = with.hands.rollAcross(with.patient.normal, with.patient.middle);
    std::vector<HandMove> moves = {
        {.seconds = 0.6, .to = axial(-6_mm), .end = with.picture("os")},
        {.seconds = 1.4, .to = axial(12_mm), .end = with.picture("canal")},
        {.seconds = 1.6, .to = axial(37_mm), .end = with.picture("cavity")},
        {.seconds = 0.5, .to = axial(37_mm, 50_deg)},
        {.seconds = 0.8, .to = axial(37_mm, -50_deg)},
        {.seconds = 0.8, .aim = before(with, 12_mm, roll, 14_mm)},
        {.seconds = 0.4, .aim = before(with, 11_mm, roll, 14_mm), .end = with.picture("polyp")}};
    // Soft tissue slips out of closing jaws, so the forceps try up to four times, from different sides and with the
    // pivot elsewhere in front of the polyp.
    const auto holds = [&forceps = with.forceps] { return static_cast<bool>(forceps.holding()); };
    const auto open = [&forceps = with.forceps] { forceps.open(); };
    const auto shut = [&forceps = with.forceps] { forceps.close(); };
    for (const auto& [turned, close] : {std::pair{0_deg, 3_mm}, {60_deg, 2.5_mm}, {-60_deg, 3.5_mm}, {0_deg, 2_mm}}) {
        const double side = roll + turned;
        moves.insert(moves.end(),
                     {{.seconds = 0.6, .aim = before(with, close + 6_mm, side), .skip = holds, .begin = open},
                      {.seconds = 0.5, .aim = before(with, close + 5_mm, side), .skip = holds},
                      {.seconds = 0.5, .aim = before(with, close + 2_mm, side), .skip = holds},
                      {.seconds = 0.5, .aim = before(with, close, side), .skip = holds},
                      {.seconds = 0.9,
                       .aim = before(with, close - 0.5_mm, side),
                       .skip = holds,
                       .begin = shut,
                       .end = with.picture("grasped")}});
    }
    moves.insert(moves.end(), {{.seconds = 1.6, .to = axial(32_mm, 0.0, 8_mm), .end = with.picture("torn")},
                               {.seconds = 2.2, .to = axial(-25_mm, 0.0, 8_mm), .begin = with.flush}});
    return moves;
}

std::vector<HandMove> clumsyMotion(const Motion& with, std::uint64_t seed)
{
    Random random(seed);
    const auto open = [&forceps = with.forceps] { forceps.open(); };
    const auto shut = [&forceps = with.forceps] { forceps.close(); };
    const auto astray = [&](double low, double high) {
        return ScopeHand{{random.between(-0.35, 0.35), 1, random.between(-0.35, 0.35)},
                         random.between(low, high),
                         random.between(-90_deg, 90_deg),
                         random.between(-6_mm, 10_mm)};
    };
    std::vector<HandMove> moves = {{.seconds = random.between(0.3, 0.8), .to = axial(random.between(-8_mm, -3_mm))}};
    for (int i = 0; i < 4; ++i) moves.push_back({.seconds = random.between(0.3, 1.0), .to = astray(-24_mm, 10_mm)});
    for (int i = 0; i < 8; ++i) moves.push_back({.seconds = random.between(0.3, 1.0), .to = astray(0.0, 40_mm)});
    for (int i = 0; i < 4; ++i) {
        const double close = random.between(0.0, 8_mm), side = random.between(-90_deg, 90_deg);
        moves.push_back({.seconds = random.between(0.3, 0.7),
                         .aim = before(with, close + random.between(2_mm, 8_mm), side),
                         .begin = open});
        moves.push_back({.seconds = random.between(0.2, 0.5), .aim = before(with, close, side)});
        moves.push_back({.seconds = random.between(0.3, 0.7), .aim = before(with, close, side), .begin = shut});
        moves.push_back({.seconds = random.between(0.2, 0.6), .to = astray(0.0, 25_mm)});
    }
    moves.push_back({.seconds = random.between(0.8, 1.5), .to = axial(-25_mm)});
    return moves;
}

} // namespace hysteroscopy
