#include "filasofia/metric/hull.h"
#include "filasofia/metric/measure.h"
#include "filasofia/metric/signal.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>

namespace filasofia::metric {
namespace {

const char* const kNoTool = "no tool was observed";

/// Why there are no speeds; empty if there are.
std::string noSpeeds(const Material& m)
{
    if (!m.tool) return kNoTool;
    for (const Motion& motion : m.motions)
        if (!motion.speeds.empty()) return {};
    return text("needs ", kMinSamples, " consecutive samples with a position, at most ", m.def.maximumGap, " s apart");
}

/// For measures that need one motion from start to end: returns nullptr, and the reason, if gaps leave less than nine
/// tenths of it whole.
const Motion* wholeMotion(const Material& m, std::string& reason)
{
    reason = noSpeeds(m);
    if (!reason.empty()) return nullptr;
    const auto longest = std::ranges::max_element(m.motions, {}, [](const Motion& each) { return each.duration(); });
    if (longest->duration() >= 0.9 * (m.last - m.first)) return &*longest;
    reason = text("too many gaps: the longest stretch without a gap is ", longest->duration(), " s of ",
                  m.last - m.first, " s");
    return nullptr;
}

double lengthOf(const Motion& motion)
{
    double sum = 0.0;
    for (std::size_t i = 1; i < motion.positions.size(); ++i)
        sum += distance(motion.positions[i], motion.positions[i - 1]);
    return sum;
}

} // namespace

Material materialOf(const Session& session, const MeasureDef& def)
{
    Material m{.session = session,
               .def = def,
               .tool = findTrack(session, Role::Tool),
               .partner = findTrack(session, Role::Tool, 1),
               .scope = findTrack(session, Role::Scope)};
    if (!m.tool) return m;
    m.motions = motionsOf(*m.tool, def);
    for (const Motion& motion : m.motions) m.moved += motion.duration();
    for (const Sample& sample : m.tool->samples) {
        if (!std::isfinite(sample.time)) continue;
        m.first = m.timed == 0 ? sample.time : std::min(m.first, sample.time);
        m.last = m.timed == 0 ? sample.time : std::max(m.last, sample.time);
        ++m.timed;
    }
    return m;
}

Value duration(const Material& m)
{
    if (!m.tool) return none(kNoTool);
    if (m.timed < 2) return none("needs at least two samples with a time");
    return found(m.last - m.first);
}

Value pathLength(const Material& m)
{
    if (std::string reason = noSpeeds(m); !reason.empty()) return none(reason);
    double sum = 0.0;
    for (const Motion& motion : m.motions) sum += lengthOf(motion);
    return found(sum);
}

Value depthPath(const Material& m)
{
    if (!m.tool) return none(kNoTool);
    double sum = 0.0;
    int steps = 0;
    const Sample* before = nullptr;
    for (const Sample& sample : m.tool->samples) {
        if (!std::isfinite(sample.time) || !isFinite(sample.pose)) continue;
        const Vec3 way = before ? sample.pose.position - before->pose.position : Vec3{};
        const double dt = before ? sample.time - before->time : 0.0;
        if (before && dt > 0.0 && dt <= m.def.maximumGap && length(way) <= m.def.fastest * dt) {
            const Vec3 axis = normalized(rotate(before->pose.orientation, m.tool->axis) +
                                         rotate(sample.pose.orientation, m.tool->axis));
            sum += std::abs(dot(way, axis));
            ++steps;
        }
        before = &sample;
    }
    return steps > 0 ? found(sum) : none("needs two consecutive samples with position and direction");
}

Value economy(const Material& m)
{
    if (!m.session.idealPath) return none("the case specifies no ideal path");
    const Value path = pathLength(m);
    if (!path.value) return path;
    if (*path.value <= 0.0) return none("the tool did not move");
    return found(*m.session.idealPath / *path.value);
}

Value meanSpeed(const Material& m)
{
    const Value path = pathLength(m);
    return path.value ? found(*path.value / m.moved) : path;
}

Value peakSpeed(const Material& m)
{
    if (std::string reason = noSpeeds(m); !reason.empty()) return none(reason);
    Value peak = found(-1.0);
    for (const Motion& motion : m.motions)
        for (std::size_t i = 0; i < motion.speeds.size(); ++i)
            if (motion.speeds[i] > *peak.value) peak = found(motion.speeds[i], motion.timeAt(i));
    return peak;
}

namespace {

/// Calls take(start, end) for each interval at rest; the speed is interpolated linearly between samples.
template <class Take> void forEachRest(const Material& m, Take&& take)
{
    const double limit = m.def.idleSpeed;
    for (const Motion& motion : m.motions) {
        bool resting = false;
        double since = 0.0;
        for (std::size_t i = 0; i < motion.speeds.size(); ++i) {
            const double now = motion.speeds[i], time = motion.timeAt(i);
            const double before = i > 0 ? motion.speeds[i - 1] : now;
            const bool rests = now < limit;
            if (rests == resting) continue;
            const double crossing = i > 0 ? time - motion.interval * (now - limit) / (now - before) : time;
            if (resting) take(since, crossing);
            resting = rests;
            since = crossing;
        }
        if (resting) take(since, motion.start + motion.duration());
    }
}

} // namespace

Value idleShare(const Material& m)
{
    if (std::string reason = noSpeeds(m); !reason.empty()) return none(reason);
    double rest = 0.0;
    forEachRest(m, [&](double start, double end) { rest += end - start; });
    return found(rest / m.moved);
}

Value longestRest(const Material& m)
{
    if (std::string reason = noSpeeds(m); !reason.empty()) return none(reason);
    Value longest = found(0.0);
    forEachRest(m, [&](double start, double end) {
        if (end - start > *longest.value) longest = found(end - start, start);
    });
    return longest;
}

Value workingVolume(const Material& m)
{
    if (std::string reason = noSpeeds(m); !reason.empty()) return none(reason);
    std::vector<Vec3> points;
    for (const Motion& motion : m.motions)
        points.insert(points.end(), motion.positions.begin(), motion.positions.end());
    return found(hullVolume(points));
}

Value bimanualCorrelation(const Material& m)
{
    if (!m.partner) return none("only one tool was observed");
    std::string reason;
    const Motion* mine = wholeMotion(m, reason);
    if (!mine) return none(reason);
    const std::vector<Motion> others = motionsOf(*m.partner, m.def);
    // Pairs at the same moment: the partner's speed is interpolated linearly between its samples.
    double n = 0, sx = 0, sy = 0;
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t i = 0; i < mine->speeds.size(); ++i)
        for (const Motion& other : others) {
            const double place = (mine->timeAt(i) - other.start) / other.interval;
            if (other.speeds.empty() || place < -1e-9 || place > static_cast<double>(other.speeds.size() - 1) + 1e-9)
                continue;
            const auto low = static_cast<std::size_t>(
                std::clamp(std::floor(place), 0.0, static_cast<double>(other.speeds.size() - 2)));
            const double share = place - static_cast<double>(low);
            pairs.emplace_back(mine->speeds[i], (1.0 - share) * other.speeds[low] + share * other.speeds[low + 1]);
            n += 1, sx += pairs.back().first, sy += pairs.back().second;
            break;
        }
    if (pairs.size() < kMinSamples) return none("the two tools were not observed at the same time");
    double xx = 0, yy = 0, xy = 0;
    for (const auto& [x, y] : pairs) {
        xx += (x - sx / n) * (x - sx / n);
        yy += (y - sy / n) * (y - sy / n);
        xy += (x - sx / n) * (y - sy / n);
    }
    if (!(xx > 1e-20 * sx * sx / n && yy > 1e-20 * sy * sy / n))
        return none("a tool moved with constant speed, or not at all");
    return found(xy / std::sqrt(xx * yy));
}

Value sparc(const Material& m)
{
    std::string reason;
    const Motion* motion = wholeMotion(m, reason);
    if (!motion) return none(reason);
    if (motion->interval > 1.0 / 20.0) return none("needs at least 20 samples per second");
    if (*std::ranges::max_element(motion->speeds) <= 0.0) return none("the tool did not move");
    return found(spectralArcLength(motion->speeds, motion->interval));
}

Value logDimensionlessJerk(const Material& m)
{
    std::string reason;
    const Motion* motion = wholeMotion(m, reason);
    if (!motion) return none(reason);
    const double peak = *std::ranges::max_element(motion->speeds);
    if (peak <= 0.0) return none("the tool did not move");
    std::vector<double> squares;
    for (const Vec3& jerk : derivative(motion->positions, motion->interval, 3)) squares.push_back(lengthSquared(jerk));
    const double dimensionless = std::pow(motion->duration(), 3) / (peak * peak) * integral(squares, motion->interval);
    if (!(dimensionless > 0.0) || !std::isfinite(dimensionless)) return none("the tool moved without jerk");
    return found(-std::log(dimensionless));
}

Value motionFrequency(const Material& m)
{
    std::string reason;
    const Motion* motion = wholeMotion(m, reason);
    if (!motion) return none(reason);
    if (*std::ranges::max_element(motion->speeds) <= 0.0) return none("the tool did not move");
    return found(powerFrequency(derivative(motion->positions, motion->interval, 1), motion->interval));
}

Value speedPeaks(const Material& m)
{
    const Value peak = peakSpeed(m);
    if (!peak.value) return peak;
    if (*peak.value <= 0.0) return none("the tool did not move");
    int count = 0;
    for (const Motion& motion : m.motions) count += countPeaks(motion.speeds, m.def.peakShare * *peak.value);
    return found(count);
}

} // namespace filasofia::metric
