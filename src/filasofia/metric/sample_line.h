#pragma once

#include "filasofia/metric/session.h"

#include <optional>
#include <span>
#include <string_view>

namespace filasofia::metric {

/// How many numbers a sample may have: its pose, with force and contacts, with the strongest contact's point.
inline constexpr std::size_t kNumbersOfPose = 7, kNumbersWithForce = 11, kNumbers = 14;

/// The sample of so many numbers; those that are missing are NaN. Nothing where there are too few or too many, or the
/// number of contacts is none.
std::optional<Sample> sampleOf(double time, std::span<const double> numbers);

/// Reads a line of samples as appendSampleLine() writes it, ten times as fast as a JSON reader. False where it is
/// anything else, or written in another way: then a JSON reader has to look.
bool scanSampleLine(std::string_view line, std::span<Sample> samples);

} // namespace filasofia::metric
