#include "filasofia/device/motion.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"
#include "filasofia/device/hand_limits.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace filasofia::device {
namespace {

constexpr std::string_view kHeader = "time,x,y,z,qw,qx,qy,qz,buttons";

/// The slope at a sample between two intervals with slopes `before` and `after`: zero if the path turns back, otherwise
/// between the two, nearer to the smaller one.
double slopeBetween(double before, double after, double hBefore, double hAfter)
{
    if (before * after <= 0.0) return 0.0;
    const double a = (1.0 + hAfter / (hBefore + hAfter)) / 3.0;
    return before * after / (a * after + (1.0 - a) * before);
}

std::vector<Vec3> slopesOf(const std::vector<MotionSample>& samples)
{
    std::vector<Vec3> slopes(samples.size()); // at rest at both ends
    for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
        const double before = samples[i].time - samples[i - 1].time, after = samples[i + 1].time - samples[i].time;
        const Vec3 in = (samples[i].pose.position - samples[i - 1].pose.position) / before;
        const Vec3 out = (samples[i + 1].pose.position - samples[i].pose.position) / after;
        for (int k = 0; k < 3; ++k) slopes[i][k] = slopeBetween(in[k], out[k], before, after);
    }
    return slopes;
}

void checkSample(const MotionSample& sample, const std::string& place)
{
    if (!std::isfinite(sample.time)) fail(place, ": time must be finite, got ", sample.time);
    const Vec3 p = sample.pose.position;
    if (!isFinite(p) || !(length(p) <= kMaxHandDistance))
        fail(place, ": the position x, y, z must lie within ", kMaxHandDistance, " m of the origin, got ", p.x, " ",
             p.y, " ", p.z);
    const double size = std::sqrt(dot(sample.pose.orientation, sample.pose.orientation));
    if (!(std::isfinite(size) && size > 1e-6))
        fail(place, ": the quaternion qw, qx, qy, qz must have a length > 1e-06, got ", size);
}

void checkOrder(const MotionSample& before, const MotionSample& sample, const std::string& place)
{
    if (!(sample.time > before.time))
        fail(place, ": time must be > ", before.time, " s (the time of the previous sample), got ", sample.time);
}

template <class Number> bool readNumber(std::string_view word, Number& out)
{
    while (!word.empty() && word.front() == ' ') word.remove_prefix(1);
    while (!word.empty() && (word.back() == ' ' || word.back() == '\r')) word.remove_suffix(1);
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), out);
    return problem == std::errc() && end == word.data() + word.size();
}

MotionSample sampleOf(std::string_view line, const std::string& place)
{
    std::vector<std::string_view> words;
    for (std::string_view rest = line;; rest.remove_prefix(words.back().size() + 1)) {
        words.push_back(rest.substr(0, rest.find(',')));
        if (words.back().size() == rest.size()) break;
    }
    if (words.size() != 9) fail(place, ": must have 9 numbers, got ", words.size());
    std::array<double, 8> n{};
    MotionSample sample;
    bool good = readNumber(words[8], sample.buttons);
    for (std::size_t i = 0; i < n.size(); ++i) good = readNumber(words[i], n[i]) && good;
    if (!good) fail(place, ": must be 9 numbers, the last one whole and >= 0, got '", line.substr(0, 80), "'");
    sample.time = n[0];
    sample.pose = {{n[1], n[2], n[3]}, {n[4], n[5], n[6], n[7]}};
    checkSample(sample, place);
    return sample;
}

} // namespace

Motion::Motion(std::vector<MotionSample> samples, const std::string& object) : samples_(std::move(samples))
{
    if (samples_.empty()) fail(object, ": must have at least one sample, got none");
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const std::string place = text(object, ": sample ", i);
        checkSample(samples_[i], place);
        if (i > 0) checkOrder(samples_[i - 1], samples_[i], place);
        samples_[i].pose.orientation = normalized(samples_[i].pose.orientation);
    }
    slopes_ = slopesOf(samples_);
}

DeviceSample Motion::at(double time, bool loop) const
{
    const double first = samples_.front().time;
    if (loop && duration() > 0.0 && time > first) time = first + std::fmod(time - first, duration());
    const auto after = std::ranges::upper_bound(samples_, time, {}, &MotionSample::time);
    if (after == samples_.begin()) return {{samples_.front().pose}, samples_.front().buttons};
    if (after == samples_.end()) return {{samples_.back().pose}, samples_.back().buttons};

    const MotionSample &a = *(after - 1), &b = *after;
    const auto place = static_cast<std::size_t>(after - samples_.begin());
    const Vec3 va = slopes_[place - 1], vb = slopes_[place];
    const double h = b.time - a.time, s = (time - a.time) / h;
    const Vec3 rise = b.pose.position - a.pose.position;
    // Hermite's cubic from a to b, written so that it equals a exactly at 0.
    const Vec3 c2 = 3.0 * rise - h * (2.0 * va + vb), c3 = h * (va + vb) - 2.0 * rise;
    const Vec3 turn = rotationVector(b.pose.orientation * conjugate(a.pose.orientation));
    DeviceSample sample{.buttons = a.buttons};
    sample.hand.pose.position = a.pose.position + s * (h * va + s * (c2 + s * c3));
    sample.hand.velocity = va + (s / h) * (2.0 * c2 + 3.0 * s * c3);
    sample.hand.pose.orientation = axisAngle(turn, s * length(turn)) * a.pose.orientation;
    sample.hand.angularVelocity = turn / h;
    return sample;
}

Motion readMotion(const std::string& file)
{
    LineReader lines(file, text("motion file '", file, "'"));
    std::vector<MotionSample> samples;
    bool headed = false;
    while (const std::optional<std::string_view> line = lines.next()) {
        if (line->empty() || line->front() == '#') continue;
        if (!headed) {
            if (*line != kHeader) fail(lines.place(), ": must be '", kHeader, "', got '", line->substr(0, 80), "'");
            headed = true;
            continue;
        }
        samples.push_back(sampleOf(*line, lines.place()));
        if (samples.size() > 1) checkOrder(samples[samples.size() - 2], samples.back(), lines.place());
    }
    return {std::move(samples), text("motion file '", file, "'")};
}

MotionWriter::MotionWriter(const std::string& file)
try : out_(std::make_unique<OutputFile>(file)) {
    out_->write(text(kHeader, '\n'));
} catch (const Error& error) {
    fail("motion file ", error.what());
}

void MotionWriter::write(const MotionSample& sample)
{
    if (last_ && !(sample.time > *last_)) return;
    last_ = sample.time;
    const auto& [p, q] = sample.pose;
    if (out_->failed()) return;
    try {
        out_->write(text(sample.time, ',', p.x, ',', p.y, ',', p.z, ',', q.w, ',', q.x, ',', q.y, ',', q.z, ',',
                         sample.buttons, '\n'));
    } catch (const Error&) { // a run goes on without its file, and close() tells it
    }
}

void MotionWriter::close()
{
    if (out_->failed()) fail(out_->name(), ": cannot be written completely; the disk may be full");
    out_->close();
}

} // namespace filasofia::device
