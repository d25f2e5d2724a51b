#include "filasofia/metric/motion.h"

#include "filasofia/metric/signal.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::metric {
namespace {

struct Point {
    double time;
    Vec3 position;
};

std::vector<Point> pointsOf(const Track& track)
{
    std::vector<Point> points;
    for (const Sample& sample : track.samples)
        if (std::isfinite(sample.time) && isFinite(sample.pose.position) &&
            (points.empty() || sample.time > points.back().time))
            points.push_back({sample.time, sample.pose.position});
    return points;
}

/// True if there is neither a gap nor a jump between two points.
bool goesOn(const Point& before, const Point& after, const MeasureDef& def)
{
    const double dt = after.time - before.time;
    return dt <= def.maximumGap && distance(after.position, before.position) <= def.fastest * dt;
}

double medianInterval(std::span<const Point> points)
{
    std::vector<double> intervals;
    for (std::size_t i = 1; i < points.size(); ++i) intervals.push_back(points[i].time - points[i - 1].time);
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    return *middle;
}

/// The cubic through the four points around a time; `after` is the first that is later.
Vec3 cubic(std::span<const Point> points, std::size_t after, double time)
{
    const std::size_t width = std::min<std::size_t>(4, points.size());
    const std::size_t first = std::min(after < 2 ? 0 : after - 2, points.size() - width);
    Vec3 sum = {};
    for (std::size_t i = first; i < first + width; ++i) {
        double weight = 1.0; // Lagrange
        for (std::size_t j = first; j < first + width; ++j)
            if (j != i) weight *= (time - points[j].time) / (points[i].time - points[j].time);
        sum += weight * points[i].position;
    }
    return sum;
}

Motion motionOf(std::span<const Point> points, const MeasureDef& def)
{
    Motion motion{.start = points.front().time, .interval = 1.0};
    if (points.size() == 1) {
        motion.positions = {points.front().position};
        return motion;
    }
    const double whole = points.back().time - points.front().time;
    motion.interval = whole / static_cast<double>(points.size() - 1);
    const bool even = [&] {
        for (std::size_t i = 0; i < points.size(); ++i)
            if (std::abs(points[i].time - motion.timeAt(i)) > 1e-6 * motion.interval) return false;
        return true;
    }();
    if (even) {
        for (const Point& point : points) motion.positions.push_back(point.position);
    } else {
        const double count = std::max(1.0, std::round(whole / medianInterval(points)));
        motion.interval = whole / count;
        std::size_t after = 0;
        for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
            const double time = motion.timeAt(i);
            while (after + 1 < points.size() && points[after].time <= time) ++after;
            motion.positions.push_back(cubic(points, after, time));
        }
    }
    lowPass(motion.positions, motion.interval, def.lowPass);
    if (motion.positions.size() >= kMinSamples)
        for (const Vec3& velocity : derivative(motion.positions, motion.interval, 1))
            motion.speeds.push_back(length(velocity));
    return motion;
}

} // namespace

std::vector<Motion> motionsOf(const Track& track, const MeasureDef& def)
{
    const std::vector<Point> points = pointsOf(track);
    std::vector<Motion> motions;
    for (std::size_t first = 0; first < points.size();) {
        std::size_t end = first + 1;
        while (end < points.size() && goesOn(points[end - 1], points[end], def)) ++end;
        motions.push_back(motionOf(std::span(points).subspan(first, end - first), def));
        first = end;
    }
    return motions;
}

} // namespace filasofia::metric
