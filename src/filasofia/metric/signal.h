#pragma once

#include "filasofia/math/vec3.h"

#include <complex>
#include <span>
#include <vector>

/// Arithmetic of evenly sampled signals.
namespace filasofia::metric {

/// The weights of values at `nodes` whose sum is the derivative of an order [-], in [0, nodes), at `at` of the
/// polynomial through them (Fornberg, Mathematics of Computation 51, 1988).
std::vector<double> derivativeWeights(double at, std::span<const double> nodes, int order);

/// The derivative of an order in [1, 6], at every sample, of polynomials of degree 6 through the seven nearest samples;
/// needs kFewest samples.
std::vector<Vec3> derivative(const std::vector<Vec3>& values, double interval, int order);

/// The integral by Simpson's rule, with the 3/8 rule at the end where their number is even.
double integral(const std::vector<double>& values, double interval);

/// Butterworth of second order, forwards and backwards: at a frequency f the gain is 1 / (1 + (tan(pi f h) / tan(pi
/// cutoff h))^4) exactly. Beyond its ends the signal is thought to go on, turned about them. Unchanged where cutoff is
/// not below 0.4 / interval.
void lowPass(std::vector<Vec3>& values, double interval, double cutoff);

/// The discrete Fourier transform in place; the size is a power of two.
void fourier(std::vector<std::complex<double>>& values);
/// The smallest power of two that is not less than n.
std::size_t powerOfTwo(std::size_t n);

/// Spectral arc length of a speed profile (Balasubramanian 2015): minus the length of its normalised amplitude
/// spectrum up to where it stays below 5 %, at most 10 Hz.
double spectralArcLength(const std::vector<double>& speeds, double interval);

/// The frequency [Hz] below which 95 % of the power of a velocity lies.
double powerFrequency(const std::vector<Vec3>& velocities, double interval);

/// How often a signal rises and falls by at least `rise`; what is still rising at the end, or falls from the start, is
/// no peak.
int countPeaks(const std::vector<double>& values, double rise);

} // namespace filasofia::metric
