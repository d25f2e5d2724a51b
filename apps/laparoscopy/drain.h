#pragma once

#include <filasofia/filasofia.h>

#include <array>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

/// A piece of drain with a slit along it, a mark on each side, a needle in a cushion, and its thread. The drain's own
/// coordinates are x across the slit, y away from it, and z along the slit towards the trainee, from the middle between
/// the marks.
namespace suturing {

inline constexpr double kRadius = 9e-3;                            ///< [m], the needle's arc
inline constexpr double kMark = 7e-3;                              ///< [m] from the slit to a mark
inline constexpr double kArc = 200.0 * (std::numbers::pi / 180.0); ///< [rad], the needle from its tip to its tail
inline constexpr double kThreadSpacing = 0.4e-3;                   ///< [m]
enum Wall { LeftWall, RightWall };

struct Drain {
    filasofia::Pose pose = {}; ///< where its own coordinates are, at rest
    std::array<filasofia::BodyId, 2> walls = {};
    std::array<int, 2> marks = {}, lips = {};   ///< nodes of the walls: at the marks, and between them at the slit
    std::array<std::vector<int>, 2> outer = {}; ///< nodes of the walls: their outer faces
    filasofia::BodyId needle = {}, thread = {}, dots = {};

    [[nodiscard]] filasofia::Vec3 mark(const filasofia::frame::Frame& now, Wall wall) const;
    [[nodiscard]] double gap(const filasofia::frame::Frame& now) const; ///< [m], how far the slit gapes at the marks
    /// [m], along the needle's line, this angle behind its tip; and the direction towards the middle of its arc.
    [[nodiscard]] filasofia::Vec3 onNeedle(const filasofia::frame::Frame& now, double angle) const;
    [[nodiscard]] filasofia::Vec3 inward(const filasofia::frame::Frame& now, double angle) const;
};

/// Adds drain, board, table, cushion, needle and thread. `towards` is the trocar of the right hand: the slit points to
/// it, and the needle stands across the shaft that comes from there. Every seed has another place and another angle.
Drain addDrain(filasofia::Simulation& sim, const filasofia::TrocarDef& towards, std::uint64_t seed);
/// Lets the needle, or the last of it, go.
void releaseThread(filasofia::Simulation& sim, const Drain& drain);
/// Draws the walls apart with this force [N] each.
void load(filasofia::Simulation& sim, const Drain& drain, double force);

/// How the stitch is at present.
struct Stitch {
    std::array<std::optional<double>, 2> deviation = {}; ///< [m], ways in and out from their marks; none yet
    bool threaded = false;                               ///< thread runs through both walls
    double tail = 0.0;                                   ///< [m], thread that is left before the way in
};
Stitch stitchOf(const Drain& drain, const filasofia::frame::Frame& now);

/// What planned motions need.
struct Motion {
    filasofia::Simulation& sim;
    const Drain& drain;
    filasofia::LaparoscopicInstrument &left, &right;
    filasofia::Laparoscope& scope;
    std::function<bool()> drawn, clear, tied; ///< the thread is, nothing is in the way of the knot, it is
    /// Takes a picture of that name; empty if no pictures are wanted.
    std::function<std::function<void()>(const char* name)> picture;
};
/// Takes the needle, turns it through both marks, takes it at its tip, draws the thread, and goes out of the way.
filasofia::TrocarPlan expertMotion(const Motion& with);
/// Takes the needle anywhere, and turns it somewhere near the marks. Every seed gives another motion.
filasofia::TrocarPlan clumsyMotion(const Motion& with, std::uint64_t seed);

/// The task as a whole: one session.
int suturing(const filasofia::Training& training);
std::vector<filasofia::TrainerSetting> settings(); ///< what its case files may change

} // namespace suturing
