#pragma once

#include "filasofia/engine/rigid/rigid_step.h"

/// The lines that run through channels. A place on them is a distance behind the needle's tip, along all lines of a
/// channel; ahead of the tip it is negative.
namespace filasofia::engine {

/// A line as it lies now: corners and, at each, the place on the line. Needles do not stretch; places on rods are those
/// of the rod at rest, so they name material.
class LineShape {
public:
    /// `line.body` must exist, and be a rod or have a needle. A rod ends where it was cut; it must have its first edge.
    LineShape(const Scene& scene, const ThreadedLine& line);

    [[nodiscard]] BodyId body() const { return id_; }
    [[nodiscard]] double begin() const { return places_.front(); } ///< [m]
    [[nodiscard]] double end() const { return places_.back(); }    ///< [m]
    [[nodiscard]] std::size_t segments() const { return places_.size() - 1; }
    /// [m] Where a segment begins and ends, from the front on.
    [[nodiscard]] std::pair<double, double> segment(std::size_t s) const { return {places_[s], places_[s + 1]}; }
    [[nodiscard]] double radius() const { return radius_; } ///< [m]
    [[nodiscard]] bool sharp() const { return sharp_; }     ///< it is a needle, whose front cuts
    /// Whether the line ends at a cut.
    [[nodiscard]] bool isCutOff() const { return cutOff_; }
    /// Whether a node of the rod belongs to the line.
    [[nodiscard]] bool hasNode(int node) const;

    /// The place [m] of the corner, or of the point between two corners, that is nearest to x, searched downhill from
    /// `guess`. Beyond the ends the first and the last segment are continued.
    [[nodiscard]] double nearest(Vec3 x, double guess) const;
    /// The same, without a guess.
    [[nodiscard]] double nearest(Vec3 x) const;
    [[nodiscard]] Vec3 position(double place) const; ///< [m] in the world
    /// A unit vector along the line, towards the front. It turns continuously: at a corner it is the mean of both
    /// sides.
    [[nodiscard]] Vec3 forward(double place) const;
    /// The place [m] of a point of the body, and how far from the line it is [m].
    struct Beside {
        double place = 0.0, distance = 0.0;
    };
    [[nodiscard]] Beside beside(const BodyPoint& point) const;
    /// The body's point there.
    [[nodiscard]] BodyPoint pointAt(double place, const Scene& scene, const RigidPlan& plan) const;

private:
    [[nodiscard]] std::size_t nodeAt(std::size_t corner) const;
    [[nodiscard]] std::size_t segmentAt(double place) const;
    [[nodiscard]] Vec3 forwardAtCorner(std::size_t corner) const;
    /// The parameter of the point nearest to x on the line through a segment; 0 and 1 are its ends.
    [[nodiscard]] double along(std::size_t segment, Vec3 x) const;
    [[nodiscard]] double distanceSquared(std::size_t segment, Vec3 x) const;
    [[nodiscard]] double placeOn(std::size_t segment, Vec3 x) const;

    BodyId id_;
    bool soft_ = false, reversed_ = false, cutOff_ = false, sharp_ = true;
    std::size_t body_ = 0, element_ = 0;
    std::size_t first_ = 0, nodes_ = 0; ///< rods: the first corner, counted from the front, and the number of all
    double radius_ = 0.0;
    std::vector<Vec3> corners_;  ///< [m] in the world
    std::vector<double> places_; ///< [m] ascending
};

/// All lines of a channel as they lie now.
class LineShapes {
public:
    /// Lines of bodies that do not exist any more are left out.
    LineShapes(const Scene& scene, const Channel& channel);

    [[nodiscard]] bool empty() const { return lines_.empty(); }
    /// The line of a body; null if there is none.
    [[nodiscard]] const LineShape* find(BodyId body) const;
    /// [m] Where the first line that exists begins.
    [[nodiscard]] double begin() const { return lines_.front().begin(); }
    [[nodiscard]] double end() const { return lines_.back().end(); } ///< [m]
    [[nodiscard]] double nearest(Vec3 x, double guess) const;        ///< [m]
    /// Whether one of the lines is at this place.
    [[nodiscard]] bool occupied(double place) const { return place > begin() && place < end(); }
    [[nodiscard]] const LineShape& at(double place) const;

private:
    [[nodiscard]] std::size_t indexAt(double place) const;
    std::vector<LineShape> lines_;
};

} // namespace filasofia::engine
