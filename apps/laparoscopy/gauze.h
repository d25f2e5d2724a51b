#pragma once

#include <filasofia/filasofia.h>

#include <array>
#include <vector>

/// A square of gauze with a printed circle, held by clips at three of its corners. Its own coordinates are x to the
/// right and z towards the trainee, from its middle, at rest.
namespace cutting {

inline constexpr double kSide = 100e-3;  ///< [m]
inline constexpr double kRadius = 20e-3; ///< [m], the circle's; lines are printed 1 mm inside and outside
enum Group { OnTable = 10, LeftTool, RightTool };

struct Gauze {
    filasofia::BodyId body = {};
    filasofia::Pose pose = {}; ///< where its own coordinates are, at rest

    /// [m], where a point of the gauze is now; none: no piece has it, or nothing is known yet.
    [[nodiscard]] filasofia::Vec3 at(const filasofia::FrameRef& frame, double x, double z) const;
    /// [-], a unit vector upwards, where it is now.
    [[nodiscard]] filasofia::Vec3 normalAt(const filasofia::FrameRef& frame, double x, double z) const;
};
/// Adds gauze, clips and table. The gauze lies a little differently for every seed.
Gauze addGauze(filasofia::Simulation& sim, std::uint64_t seed);

/// What has been cut, in the gauze's own coordinates.
struct CutPattern {
    double around = 0.0;    ///< [-], in [0, 1], share of the circle with a cut within 5 mm of it
    bool out = false;       ///< the middle of the circle is no part of the rim's piece any more
    double deviation = 0.0; ///< [m^2], what the piece has beyond the disc, and lacks in it; 0 until it is out
};
CutPattern patternOf(const Gauze& gauze, const filasofia::frame::SoftBodyFrame& body);

/// The task as a whole: one session.
int patternCutting(const filasofia::Training& training);
std::vector<filasofia::TrainerSetting> settings(); ///< what its case files may change

} // namespace cutting
