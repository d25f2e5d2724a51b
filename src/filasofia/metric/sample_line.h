#pragma once

#include "filasofia/metric/session.h"

#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace filasofia::metric {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN(); ///< what a sample lacks

/// The possible sizes of a sample: its pose; with force and contacts; with the point of the strongest contact too.
inline constexpr std::size_t kNumbersOfPose = 7, kNumbersWithForce = 11, kNumbers = 14;

/// The sample of these numbers; missing ones are NaN. Returns nullopt if there are too few or too many numbers, or the
/// number of contacts is invalid.
std::optional<Sample> sampleOf(double time, std::span<const double> numbers);

/// Reads a line of samples as appendSampleLine() writes it, ten times as fast as a JSON reader. False if it is anything
/// else, or formatted differently: then a JSON reader has to parse it.
bool scanSampleLine(std::string_view line, std::span<Sample> samples);

} // namespace filasofia::metric
