#pragma once

#include <filasofia/filasofia.h>

#include <array>
#include <atomic>
#include <optional>
#include <vector>

/// A piece of foam with three tubular appendages, and a pre-tied loop at the tip of a pusher.
namespace ligating {

inline constexpr double kRadius = 4.5e-3;  ///< [m], an appendage's, at rest
inline constexpr double kLength = 50e-3;   ///< [m], from its base to its tip
inline constexpr double kMark = 15e-3;     ///< [m], from its base to the middle of its mark
inline constexpr double kMarkWidth = 1e-3; ///< [m]
enum Group { LeftTool = 20, OnThread };

/// Three appendages of soft foam; the one in the middle is to be tied off.
struct Foam {
    std::array<filasofia::BodyId, 3> appendages = {}; ///< from the left to the right
    std::array<filasofia::Pose, 3> poses = {};        ///< from the base of each at rest; its y points to its tip

    [[nodiscard]] filasofia::BodyId target() const { return appendages[1]; }
    /// [m], the middle of the target's cross-sections, from its base to its tip; none before the first frame.
    [[nodiscard]] std::vector<filasofia::Vec3> line(const filasofia::FrameRef& frame) const;
    /// [m], the middle of the target so far from its base, at rest before the first frame.
    [[nodiscard]] filasofia::Vec3 at(const filasofia::FrameRef& frame, double place) const;
    /// [-], a unit vector towards its tip there.
    [[nodiscard]] filasofia::Vec3 along(const filasofia::FrameRef& frame, double place) const;
    /// [-], by how much its diameter is smaller than at rest, where it is narrowest within 2 mm of a place.
    [[nodiscard]] double narrowing(const filasofia::FrameRef& frame, double place) const;
};
/// Adds foam and table. The foam stands a little differently for every seed.
Foam addFoam(filasofia::Simulation& sim, std::uint64_t seed);

/// The pusher: a tube through the right trocar. It grasps nothing; closing its jaws means drawing the thread.
filasofia::LaparoscopicInstrumentDef pusherOf(const filasofia::Training& training);

/// The thread: its loop is before the pusher's mouth, one end is tied into the knot there, and the other one runs
/// through the pusher to a hand. While the pusher's jaws are closed, the hand draws the thread with a force; otherwise
/// it holds it. The knot is rigid and lets the thread slip as long as it is at the pusher. When it is let go, it
/// is fixed to the thread that runs through it, until that is pulled with more than it bears, and is free.
class Endoloop {
public:
    Endoloop(filasofia::Simulation& sim, const filasofia::LaparoscopicInstrument& pusher);

    void letGo() { asked_ = true; } ///< from the next step on; any thread
    [[nodiscard]] bool isFree() const { return free_; }
    /// [m], the loop as a closed line, from the knot once around; none before the first frame.
    [[nodiscard]] std::vector<filasofia::Vec3> loop(const filasofia::FrameRef& frame) const;
    [[nodiscard]] filasofia::Vec3 knot(const filasofia::FrameRef& frame) const; ///< [m]

private:
    void step();
    [[nodiscard]] double drawn(const filasofia::frame::Frame& now) const; ///< [m], the thread's length
    void fix(const filasofia::frame::Frame& now);
    /// The nodes of the thread before the pusher's mouth, or up to the knot.
    [[nodiscard]] std::size_t ahead(const filasofia::frame::Frame& now) const;

    filasofia::Simulation& sim_;
    const filasofia::LaparoscopicInstrument& pusher_;
    filasofia::BodyId knot_ = {}, hand_ = {}, thread_ = {};
    bool drawing_ = false;
    std::atomic<bool> asked_ = false, free_ = false;
    std::atomic<std::size_t> fixed_ = 0; ///< nodes up to the knot, once it is free
};

/// Where a closed line runs around another one, which begins at the foam: [m] along that one from its beginning; none
/// if the closed one does not go around it exactly once.
std::optional<double> placeAround(const std::vector<filasofia::Vec3>& loop, const std::vector<filasofia::Vec3>& line);

/// The task as a whole: one session.
int ligatingLoop(const filasofia::Training& training);
std::vector<filasofia::TrainerSetting> settings(); ///< what its case files may change

} // namespace ligating
