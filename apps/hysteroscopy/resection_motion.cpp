#include "apps/hysteroscopy/motion.h"

#include <filasofia/core/random.h>

using namespace filasofia;

namespace hysteroscopy {
namespace {

constexpr double kHidden = -6e-3;  ///< [m], reach of a loop that is in the sheath
constexpr double kMiddle = 14e-3;  ///< [m], reach above the middle of the myoma
constexpr double kBeyond = 1.3e-3; ///< [m], by which a stroke is longer than the tissue, at both ends

ScopeHand straight(double y, double roll = 0.0, double reach = kHidden)
{
    return {{0, 1, 0}, y - kFulcrum.y, roll, reach};
}

/// Where a stroke goes: the myoma's root and three directions.
struct Bed {
    Vec3 root = {}, across = {}, up = {}, ahead = {}; // away from the scope
};
Bed bedOf(const ResectionMotion& with)
{
    const Vec3 root = with.root(), up = with.patient.normal;
    const Vec3 across = normalized(cross(root - kFulcrum, up));
    return {root, across, up, cross(up, across)};
}

/// How the scope is held so that the loop's bottom is `bottom` [m] above the wall, `side` [m] beside the myoma's middle
/// and `ahead` [m] beyond it, with the loop across the wall.
ScopeHand above(const ResectionMotion& with, double bottom, double side, double ahead)
{
    const Bed bed = bedOf(with);
    const double reach = kMiddle + ahead;
    const Vec3 place = bed.root + side * bed.across + ahead * bed.ahead + (bottom + with.loop.def().depth) * bed.up;
    ScopeHand hand = with.hands.at(place, 0.0, 0.0, reach);
    for (int i = 0; i < 3; ++i) { // the channel's place depends on the roll
        const Quat unrolled = with.hands.tip({.aim = hand.aim}).orientation;
        const Vec3 seen = rotate(conjugate(unrolled), bed.up);
        // On the front wall it is about half a turn. If that were to the left now and to the right then, the scope
        // would turn right round between the two.
        const double roll = std::atan2(-seen.x, seen.y);
        hand = with.hands.at(place, 0.0, roll < -90_deg ? roll + 360_deg : roll, reach);
    }
    return hand;
}

/// The tissue that a stroke would meet.
struct Span {
    double from = std::numeric_limits<double>::infinity(); ///< [m] ahead of the myoma's middle, the end near the scope
    double to = -std::numeric_limits<double>::infinity();  ///< [m]
    double thickest = 0.0;                                 ///< [m] above the wire
};
Span spanOf(const ResectionMotion& with, double bottom, double side)
{
    const Bed bed = bedOf(with);
    const double radius = 0.5 * with.loop.def().width;
    Span out;
    for (const Vec3& point : with.surface()) {
        const Vec3 from = point - bed.root;
        const double beside = dot(from, bed.across) - side;
        if (std::abs(beside) >= radius) continue;
        const double thick = dot(from, bed.up) - bottom - radius + std::sqrt(radius * radius - beside * beside);
        if (thick <= 0.0) continue;
        out.from = std::min(out.from, dot(from, bed.ahead));
        out.to = std::max(out.to, dot(from, bed.ahead));
        out.thickest = std::max(out.thickest, thick);
    }
    return out;
}

/// [m] How deep the wire would be in the wall, at five places of a stroke.
double depthOf(const ResectionMotion& with, double bottom, double side, const Span& span)
{
    const Bed bed = bedOf(with);
    const double from = span.from - kBeyond, to = span.to + kBeyond;
    double deepest = 0.0;
    for (const Vec3& wire : with.loop.line())
        for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0})
            deepest = std::max(deepest, with.wall(bed.root + (side + wire.x) * bed.across +
                                                  (from + part * (to - from)) * bed.ahead +
                                                  (bottom + with.loop.def().depth + wire.y) * bed.up));
    return deepest;
}

/// One stroke, planned when it begins: lifted, beyond the tissue, then down, and with current back to the scope.
struct Stroke {
    double bottom = 0.0; ///< [m] above the wall
    double side = 0.0;   ///< [m]
    Span span = {};
    [[nodiscard]] bool worthIt() const { return span.thickest > 1_mm; }
};
void plan(const ResectionMotion& with, Stroke& stroke)
{
    stroke.span = spanOf(with, stroke.bottom, stroke.side);
    if (!stroke.worthIt()) return;
    // The wall is uneven.
    stroke.bottom += std::max(depthOf(with, stroke.bottom, stroke.side, stroke.span) - 0.5_mm, 0.0);
    stroke.span = spanOf(with, stroke.bottom, stroke.side);
}

/// Adds a stroke, which is left out if nothing is there. `picture` gives the function that takes a picture of a name.
void draw(const ResectionMotion& with, double bottom, double side, auto picture, std::vector<HandMove>& moves)
{
    const double high = with.patient.height + 0.7_mm;
    const auto stroke = std::make_shared<Stroke>();
    const auto none = [stroke] { return !stroke->worthIt(); };
    const auto look = [=] {
        *stroke = {bottom, side};
        plan(with, *stroke);
        return none();
    };
    const auto far = [=](double lifted) {
        return [=] { return above(with, std::max(stroke->bottom, lifted), side, stroke->span.to + kBeyond); };
    };
    const auto near = [=](double lifted) {
        return [=] { return above(with, std::max(stroke->bottom, lifted), side, stroke->span.from - kBeyond); };
    };
    const auto half = [=] { return above(with, stroke->bottom, side, 0.5 * (stroke->span.from + stroke->span.to)); };
    const auto press = [&loop = with.loop](bool on) { return [&loop, on] { loop.cut(on); }; };
    moves.push_back({.seconds = 0.6, .aim = far(high), .skip = look});
    moves.push_back({.seconds = 0.3, .aim = far(0.0), .skip = none, .end = picture("loop")});
    moves.push_back({.seconds = 0.6, .aim = half, .skip = none, .begin = press(true), .end = picture("cut")});
    moves.push_back({.seconds = 0.6, .aim = near(0.0), .skip = none, .end = press(false)});
    moves.push_back({.seconds = 0.3, .aim = near(high), .skip = none, .end = picture("chip")});
}

} // namespace

std::vector<HandMove> expertResection(const ResectionMotion& with)
{
    const auto overview = [with] { return straight(36_mm, above(with, 4_mm, 0.0, 0.0).roll); };
    std::vector<HandMove> moves = {{.seconds = 0.6, .to = straight(-6_mm)},
                                   {.seconds = 1.4, .to = straight(12_mm)},
                                   {.seconds = 1.6, .to = straight(34_mm)},
                                   {.seconds = 0.8, .aim = overview, .end = with.picture("myoma")}};
    const auto unseen = [](const char*) { return std::function<void()>(); };
    draw(with, 4_mm, 0.0, unseen, moves);
    draw(with, 2.4_mm, 1.8_mm, with.picture, moves);
    draw(with, 2.4_mm, -1.8_mm, unseen, moves);
    for (int round = 0; round < 2; ++round) // what the first left hanging, the second takes
        for (const double side : {0.0, 2.8_mm, -2.8_mm}) draw(with, 0.5_mm, side, unseen, moves);
    moves.insert(moves.end(), {{.seconds = 0.8, .aim = overview, .begin = with.flush, .end = with.picture("bed")},
                               {.seconds = 2.2, .to = straight(-25_mm)}});
    return moves;
}

std::vector<HandMove> clumsyResection(const ResectionMotion& with, std::uint64_t seed)
{
    Random random(seed);
    const auto press = [&loop = with.loop](bool on) { return [&loop, on] { loop.cut(on); }; };
    std::vector<HandMove> moves = {{.seconds = random.between(0.8, 1.2), .to = straight(5_mm)},
                                   {.seconds = random.between(1.0, 1.6), .to = straight(34_mm)}};
    for (int i = 0; i < 8; ++i) {
        const double side = random.between(-6_mm, 6_mm), bottom = random.between(-3_mm, 5_mm);
        const double roll = random.between(-25_deg, 25_deg), far = random.between(4_mm, 11_mm);
        const double deeper = random.between(-3_mm, 3_mm);
        const auto rolled = [=](double beyond, double depth) {
            return [=] {
                ScopeHand hand = above(with, bottom, side, beyond);
                hand.roll += roll;
                hand.depth += depth;
                return hand;
            };
        };
        moves.push_back({.seconds = random.between(0.4, 0.9), .aim = rolled(far, 0.0)});
        moves.push_back({.seconds = random.between(0.4, 1.2),
                         .aim = rolled(-far, deeper),
                         .begin = press(random.between(0.0, 1.0) < 0.8),
                         .end = press(random.between(0.0, 1.0) < 0.3)});
    }
    moves.push_back({.seconds = random.between(0.5, 1.0), .to = straight(32_mm), .begin = press(false)});
    moves.push_back({.seconds = random.between(0.8, 1.5), .to = straight(-25_mm)});
    return moves;
}

} // namespace hysteroscopy
