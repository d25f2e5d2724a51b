#include "filasofia/metric/signal.h"

#include "filasofia/core/assert.h"
#include "filasofia/metric/motion.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace filasofia::metric {

std::vector<double> derivativeWeights(double at, std::span<const double> nodes, int order)
{
    const std::size_t n = nodes.size(), m = static_cast<std::size_t>(order) + 1;
    std::vector<double> weights(n * m, 0.0); // weights[i * m + k] is the weight of order k and node i
    double before = 1.0, from = nodes[0] - at;
    weights[0] = 1.0;
    for (std::size_t i = 1; i < n; ++i) {
        double product = 1.0;
        const double old = from;
        from = nodes[i] - at;
        for (std::size_t j = 0; j < i; ++j) {
            const double apart = nodes[i] - nodes[j];
            product *= apart;
            if (j + 1 == i)
                for (std::size_t k = std::min(i, m - 1) + 1; k-- > 0;)
                    weights[i * m + k] =
                        before / product *
                        ((k > 0 ? static_cast<double>(k) * weights[j * m + k - 1] : 0.0) - old * weights[j * m + k]);
            for (std::size_t k = std::min(i, m - 1) + 1; k-- > 0;)
                weights[j * m + k] =
                    (from * weights[j * m + k] - (k > 0 ? static_cast<double>(k) * weights[j * m + k - 1] : 0.0)) /
                    apart;
        }
        before = product;
    }
    std::vector<double> asked(n);
    for (std::size_t i = 0; i < n; ++i) asked[i] = weights[i * m + m - 1];
    return asked;
}

std::vector<Vec3> derivative(const std::vector<Vec3>& values, double interval, int order)
{
    constexpr std::size_t width = kMinSamples, middle = width / 2;
    FILASOFIA_ASSERT(values.size() >= width);
    std::array<double, width> nodes = {};
    for (std::size_t i = 0; i < width; ++i) nodes[i] = static_cast<double>(i);
    std::array<std::vector<double>, width> weights; // for each position within the seven
    for (std::size_t i = 0; i < width; ++i) weights[i] = derivativeWeights(static_cast<double>(i), nodes, order);
    const double scale = std::pow(interval, -order);
    std::vector<Vec3> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t first = std::min(i < middle ? 0 : i - middle, values.size() - width);
        // Use differences to the value itself: digits that all seven share would be lost in the sum.
        for (std::size_t k = 0; k < width; ++k) out[i] += weights[i - first][k] * (values[first + k] - values[i]);
        out[i] *= scale;
    }
    return out;
}

double integral(const std::vector<double>& values, double interval)
{
    const std::size_t n = values.size();
    if (n < 2) return 0.0;
    if (n == 2) return 0.5 * interval * (values[0] + values[1]);
    const std::size_t simpson = n % 2 == 1 ? n : n - 3; // samples under Simpson's rule; at least 1
    double sum = 0.0;
    for (std::size_t i = 0; i + 2 < simpson; i += 2) sum += (values[i] + 4.0 * values[i + 1] + values[i + 2]) / 3.0;
    if (simpson != n) {
        const double* last = &values[n - 4];
        sum += 3.0 / 8.0 * (last[0] + 3.0 * last[1] + 3.0 * last[2] + last[3]);
    }
    return sum * interval;
}

namespace {

/// One pass of the filter, started in the state that a constant signal of the first value would have left.
void pass(std::vector<Vec3>& values, double gain, double a1, double a2)
{
    Vec3 x1 = values.front(), x2 = x1, y1 = x1, y2 = x1;
    for (Vec3& value : values) {
        const Vec3 x = value;
        value = gain * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        x2 = x1, x1 = x;
        y2 = y1, y1 = value;
    }
}

} // namespace

void lowPass(std::vector<Vec3>& values, double interval, double cutoff)
{
    if (cutoff <= 0.0 || cutoff * interval >= 0.4 || values.size() < 2) return;
    const double c = std::tan(std::numbers::pi * cutoff * interval);
    const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * c + c * c);
    const double gain = c * c * scale, a1 = 2.0 * (c * c - 1.0) * scale,
                 a2 = (1.0 - std::numbers::sqrt2 * c + c * c) * scale;
    // Extended by reflection about its end points, the signal keeps value and slope there: the filter starts without a
    // transient.
    const auto wanted = static_cast<std::size_t>(3.0 / (cutoff * interval));
    const std::size_t pad = std::min(values.size() - 1, wanted);
    std::vector<Vec3> longer;
    longer.reserve(values.size() + 2 * pad);
    for (std::size_t i = pad; i > 0; --i) longer.push_back(2.0 * values.front() - values[i]);
    longer.insert(longer.end(), values.begin(), values.end());
    for (std::size_t i = 1; i <= pad; ++i) longer.push_back(2.0 * values.back() - values[values.size() - 1 - i]);
    for (int way = 0; way < 2; ++way) {
        pass(longer, gain, a1, a2);
        std::reverse(longer.begin(), longer.end());
    }
    std::copy_n(longer.begin() + static_cast<std::ptrdiff_t>(pad), values.size(), values.begin());
}

std::size_t powerOfTwo(std::size_t n) { return std::bit_ceil(n); }

void fourier(std::vector<std::complex<double>>& values)
{
    const std::size_t n = values.size();
    FILASOFIA_ASSERT(std::has_single_bit(n));
    for (std::size_t i = 1, j = 0; i < n; ++i) { // bit-reversal permutation
        std::size_t bit = n >> 1;
        for (; j & bit; bit >>= 1) j ^= bit;
        j ^= bit;
        if (i < j) std::swap(values[i], values[j]);
    }
    std::vector<std::complex<double>> turns(n / 2);
    for (std::size_t i = 0; i < turns.size(); ++i)
        turns[i] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    for (std::size_t size = 2; size <= n; size *= 2)
        for (std::size_t first = 0; first < n; first += size)
            for (std::size_t k = 0; k < size / 2; ++k) {
                const auto even = values[first + k], odd = turns[k * (n / size)] * values[first + k + size / 2];
                values[first + k] = even + odd;
                values[first + k + size / 2] = even - odd;
            }
}

double spectralArcLength(const std::vector<double>& speeds, double interval)
{
    constexpr double highest = 10.0, threshold = 0.05;        // [Hz], [-]; from the 2015 paper
    constexpr std::size_t largestSize = std::size_t{1} << 22; // 64 MB; only a session of an hour gets less padding
    const std::size_t size = std::max(powerOfTwo(speeds.size()), std::min(largestSize, 16 * powerOfTwo(speeds.size())));
    std::vector<std::complex<double>> spectrum(size);
    std::copy(speeds.begin(), speeds.end(), spectrum.begin());
    fourier(spectrum);
    const double step = 1.0 / (interval * static_cast<double>(size)); // [Hz]
    std::vector<double> amplitudes;
    for (std::size_t k = 0; k <= size / 2 && step * static_cast<double>(k) <= highest; ++k)
        amplitudes.push_back(std::abs(spectrum[k]));
    // A speed is never negative, so its spectrum is largest at 0.
    const double largest = amplitudes.front();
    while (amplitudes.size() > 1 && amplitudes.back() < threshold * largest) amplitudes.pop_back();
    const double width = 1.0 / static_cast<double>(std::max<std::size_t>(1, amplitudes.size() - 1));
    double length = 0.0;
    for (std::size_t k = 1; k < amplitudes.size(); ++k)
        length += std::hypot(width, (amplitudes[k] - amplitudes[k - 1]) / largest);
    return -length;
}

double powerFrequency(const std::vector<Vec3>& velocities, double interval)
{
    const std::size_t size = powerOfTwo(velocities.size());
    std::vector<double> power(size / 2 + 1);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<std::complex<double>> spectrum(size);
        for (std::size_t i = 0; i < velocities.size(); ++i) spectrum[i] = velocities[i][axis];
        fourier(spectrum);
        for (std::size_t k = 0; k < power.size(); ++k) // a frequency and its mirror image, except 0 and the last
            power[k] += std::norm(spectrum[k]) * (k == 0 || k == size / 2 ? 1.0 : 2.0);
    }
    double total = 0.0, sum = 0.0;
    for (const double each : power) total += each;
    std::size_t k = 0;
    for (; k + 1 < power.size(); ++k)
        if ((sum += power[k]) >= 0.95 * total) break;
    return static_cast<double>(k) / (interval * static_cast<double>(size));
}

int countPeaks(const std::vector<double>& values, double rise)
{
    if (values.empty()) return 0;
    int peaks = 0;
    bool rising = false;
    double low = values.front(), high = values.front();
    for (const double value : values) {
        low = std::min(low, value);
        high = std::max(high, value);
        if (rising && value <= high - rise) {
            ++peaks;
            rising = false;
            low = value;
        } else if (!rising && value >= low + rise) {
            rising = true;
            high = value;
        }
    }
    return peaks;
}

} // namespace filasofia::metric
