#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <array>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A straight piece of a blade, now and one step ago. A blade is any number of segments in any order: a line, a strip,
/// a ring, or the two jaws of scissors. If exactly two segments end in one place, they are one edge that bends there.
struct BladeSegment {
    Vec3 from = {};       ///< [m]
    Vec3 to = {};         ///< [m]
    Vec3 fromBefore = {}; ///< [m]
    Vec3 toBefore = {};   ///< [m]
};

/// How the segments of a blade hang together, and which way they went recently. The surface that a segment cuts has its
/// normal along `along (to - from) x direction`. So the normals of a chain agree all along it, and all around a ring.
class BladeRuns {
public:
    struct Joint {
        int segment = -1; ///< -1: no other segment ends there, or more than one
        int end = 0;      ///< 0: at its `from`, 1: at its `to`
    };

    /// Finds the joints. Call this whenever the blade begins a new pass or may be another one. A ring that is narrow
    /// for the mean edge [m] of the tissue, as the rim of a thin strip, is no punch: its segments cut by themselves.
    void join(std::span<const BladeSegment> blade, int pass, double meanEdge);
    /// Learns from a step in which the tissue at the blade moved by `tissue`. The direction is averaged over a way of
    /// about `memory` [m].
    void follow(std::span<const BladeSegment> blade, Vec3 tissue, double memory);

    [[nodiscard]] Joint joint(int segment, int end) const { return joints_[segment][end]; }
    [[nodiscard]] double along(int segment) const { return along_[segment]; } ///< 1, or -1 if it runs against its chain
    [[nodiscard]] Vec3 direction(int segment) const { return directions_[segment]; } ///< [m]
    /// The first segment of those that are joined to this one and cut with the same side ahead. A segment that moves
    /// along itself, as the sides of a blade that is pushed down, cuts nothing and is on its own.
    [[nodiscard]] int run(int segment) const { return runs_[segment]; }

    /// At the parameter u along the segment and the fraction t of the last step. Not known if no other segment is
    /// joined to it: the surface of a straight blade needs no more than its labels' planes.
    [[nodiscard]] SweptPlace placeAt(int segment, double u, double t) const;
    /// [m] How far two places are from each other along what was swept; infinite if that is not known.
    [[nodiscard]] double distanceBetween(const SweptPlace& a, const SweptPlace& b) const;

    /// Whether the normals of the crossings there are those of the sheet (1) or opposite (-1); 0: not known.
    [[nodiscard]] int sideAt(const SweptPlace& place) const { return place.pass == pass_ ? sides_[place.segment] : 0; }
    /// Tells that. It then holds for all segments of the run that have no side.
    void setSideAt(const SweptPlace& place, int side);

private:
    void orderChains(std::span<const BladeSegment> blade);
    [[nodiscard]] double widthOf(int ring, std::span<const BladeSegment> blade) const;
    void separate(int chain);
    void findRuns(std::span<const BladeSegment> blade);

    struct Stretch {
        double from = 0.0, to = 0.0;    ///< [m] along the chain, at the segment's ends
        double before = 0.0, now = 0.0; ///< [m] way at the start and the end of the step
    };
    int pass_ = 0;
    std::vector<std::array<Joint, 2>> joints_;
    std::vector<double> along_;
    std::vector<int> chains_;   ///< per segment, the first of those joined to it
    std::vector<double> rings_; ///< [m] per chain: its length if it is closed, or 0
    std::vector<int> runs_, sides_;
    std::vector<Vec3> directions_;
    std::vector<Stretch> stretches_;
};

} // namespace filasofia::engine
