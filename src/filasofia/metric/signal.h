#pragma once

#include "filasofia/math/vec3.h"

#include <complex>
#include <span>
#include <vector>

/// Signal processing for evenly sampled signals.
namespace filasofia::metric {

/// The weights for values at `nodes` whose weighted sum is the derivative of the given order [-], in [0, nodes), at
/// `at`, of the polynomial through them (Fornberg, Mathematics of Computation 51, 1988).
std::vector<double> derivativeWeights(double at, std::span<const double> nodes, int order);

/// The derivative of an order in [1, 6], at every sample, of polynomials of degree 6 through the seven nearest samples;
/// needs at least kMinSamples samples.
std::vector<Vec3> derivative(const std::vector<Vec3>& values, double interval, int order);

/// The integral by Simpson's rule, with the 3/8 rule at the end if the number of intervals is odd.
double integral(const std::vector<double>& values, double interval);

/// Butterworth filter of second order, forwards and backwards: at a frequency f the gain is exactly 1 / (1 + (tan(pi f
/// h) / tan(pi cutoff h))^4). The signal is extended beyond its ends by reflection about them. Values are unchanged if
/// cutoff is not below 0.4 / interval.
void lowPass(std::vector<Vec3>& values, double interval, double cutoff);

/// The discrete Fourier transform in place; the size must be a power of two.
void fourier(std::vector<std::complex<double>>& values);
/// The smallest power of two that is not less than n.
std::size_t powerOfTwo(std::size_t n);

/// Spectral arc length of a speed profile (Balasubramanian 2015): minus the arc length of its normalised amplitude
/// spectrum up to the frequency above which it stays below 5 %, at most 10 Hz.
double spectralArcLength(const std::vector<double>& speeds, double interval);

/// The frequency [Hz] below which 95 % of the power of a velocity lies.
double powerFrequency(const std::vector<Vec3>& velocities, double interval);

/// The number of times that a signal rises and then falls by at least `rise`; a final rise or an initial fall is not a
/// peak.
int countPeaks(const std::vector<double>& values, double rise);

} // namespace filasofia::metric
