#pragma once

#include "filasofia/metric/catalog.h"

namespace filasofia::metric {

/// An evenly sampled stretch of a track without gaps.
struct Motion {
    double start = 0.0;               ///< [s]
    double interval = 0.0;            ///< [s], > 0
    std::vector<Vec3> positions = {}; ///< [m], low-passed
    std::vector<double> speeds = {};  ///< [m/s], one per position; empty if there are fewer than kMinSamples

    [[nodiscard]] double timeAt(std::size_t i) const { return start + interval * static_cast<double>(i); }
    [[nodiscard]] double duration() const { return timeAt(positions.empty() ? 0 : positions.size() - 1) - start; }
};

/// Derivatives are those of polynomials through this many samples.
inline constexpr int kMinSamples = 7;

/// The samples with finite time and position, in increasing order of time, split where they are further apart than
/// maximumGap, or jump (fastest). Unevenly sampled stretches are resampled at the median interval by cubics through
/// four neighbours. Positions are then low-pass filtered (Butterworth of second order, forwards and backwards: no
/// delay), and speeds are the slopes of polynomials through seven neighbours.
std::vector<Motion> motionsOf(const Track& track, const MeasureDef& def = {});

} // namespace filasofia::metric
