#include "filasofia/device/haptic_servo.h"

#include "filasofia/core/error.h"
#include "filasofia/core/guarded_call.h"
#include "filasofia/core/real_time.h"
#include "filasofia/device/hand_limits.h"

#include <time.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

namespace filasofia::device {
namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;
constexpr Nanoseconds kLongCall = 20'000'000; ///< a call that takes longer means trouble

template <class T> void storeMax(std::atomic<T>& maximum, T value) // one writer only
{
    if (value > maximum.load(std::memory_order_relaxed)) maximum.store(value, std::memory_order_relaxed);
}

} // namespace

std::uint64_t JitterHistogram::total() const { return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}); }

double JitterHistogram::percentile(double share) const
{
    const auto all = static_cast<double>(total());
    if (all == 0.0) return 0.0;
    std::uint64_t sum = 0;
    for (int bin = 0; bin + 1 < kBins; ++bin) {
        sum += counts[static_cast<std::size_t>(bin)];
        if (static_cast<double>(sum) >= share * all) return (bin + 1) * kWidth;
    }
    return std::numeric_limits<double>::infinity();
}

HapticServo::HapticServo(HapticDevice& device, const ServoDef& def, ServoClock clock,
                         std::function<void(const DeviceNotice&)> notice)
    : device_(device), loop_(def), clock_(std::move(clock)), notice_(std::move(notice))
{
}

HapticServo::~HapticServo()
{
    stop();
    close();
}

void HapticServo::start(bool realTime)
{
    stop();
    stop_.store(false);
    thread_ = std::thread([this, realTime] { run(realTime); });
}

void HapticServo::stop()
{
    if (!thread_.joinable()) return;
    stop_.store(true);
    thread_.join();
}

void HapticServo::open()
{
    tryAgain_ = clock_.now() + kSecond;
    const auto problem = guardedCall([this] { // the driver may be the user's
        device_.open();
        open_ = true;
        slow_ = refused_ = false;
        loop_.setCapabilities(device_.capabilities());
        loop_.interrupt();
        // Otherwise the notice comes when it has worked for a while.
        if (!reported_) notice_({.kind = DeviceNotice::Kind::Connected});
    });
    if (!problem) return;
    device_.close();
    if (!std::exchange(reported_, ServoState::Lost)) notice_({.kind = DeviceNotice::Kind::Error, .problem = *problem});
}

void HapticServo::close()
{
    if (!std::exchange(open_, false)) return;
    static_cast<void>(device_.write({}));
    device_.close();
}

std::uint64_t HapticServo::place(double scale, const Pose& origin, Quat grip)
{
    const std::lock_guard lock(placingMutex_);
    placing_.write({++placings_, scale, origin, grip});
    return placings_;
}

// A library that hangs must block nothing but this thread. What happened to the hand meanwhile is unknown, so the force
// rises from zero again.
void HapticServo::watchCall(Nanoseconds before, const char* call)
{
    const Nanoseconds took = clock_.now() - before;
    storeMax(longestCall_, took);
    if (took <= kLongCall) return;
    loop_.interrupt();
    if (!std::exchange(slow_, true))
        notice_({.kind = DeviceNotice::Kind::Error,
                 .problem = text(call, " took ", took / 1'000'000, " ms; the force rises from zero again")});
}

void HapticServo::report(ServoState state)
{
    if (isGood(state)) {
        if (std::exchange(reported_, std::nullopt)) notice_({.kind = DeviceNotice::Kind::Connected});
        return;
    }
    if (reported_ && (*reported_ == ServoState::Lost || state != ServoState::Lost)) return; // one notice per fault
    reported_ = state;
    const std::string why = device_.problem();
    notice_({.kind = state == ServoState::Lost ? DeviceNotice::Kind::Lost : DeviceNotice::Kind::Error,
             .problem = text(describe(state), why.empty() ? "" : ": ", why)});
}

void HapticServo::reportButtons(std::uint32_t buttons)
{
    std::uint32_t changed = buttons ^ std::exchange(buttons_, buttons);
    for (; changed != 0; changed &= changed - 1) { // without its lowest bit
        const int b = std::countr_zero(changed);
        notice_({.kind = DeviceNotice::Kind::Button, .button = b, .pressed = (buttons >> b & 1u) != 0});
    }
}

void HapticServo::reopenAfterAWhile()
{
    if (clock_.now() < tryAgain_) return;
    if (std::exchange(open_, false)) device_.close();
    open();
}

void HapticServo::takePlacing()
{
    Placing placing;
    if (!placing_.read(placing) || placing.number == placed_) return;
    placed_ = placing.number;
    ServoDef def = loop_.def();
    def.scale = placing.scale;
    def.origin = placing.origin;
    def.grip = placing.grip;
    loop_.setDef(def);
}

void HapticServo::tick(double time)
{
    read(time);
    render();
}

void HapticServo::read(double time)
{
    takePlacing();
    if (!open_ || sample_.status == DeviceStatus::Lost) reopenAfterAWhile();
    sampled_ = clock_.now();
    if (!open_) {
        sample_ = {.status = DeviceStatus::Lost};
        return;
    }
    sample_ = device_.read(time);
    if (sample_.status != DeviceStatus::Lost) tryAgain_ = sampled_ + kSecond;
    watchCall(sampled_, "a read");
    if (sample_.status != DeviceStatus::Ready) return;
    reportButtons(sample_.buttons);
    if (MotionSample* place = tape_ ? tape_->beginWrite() : nullptr) {
        *place = {time, sample_.hand.pose, sample_.buttons};
        tape_->publish();
    }
}

void HapticServo::render()
{
    hasBody_ = body_.read(newestBody_) || hasBody_;
    const ServoTick tick = loop_.tick(sampled_, sample_, hasBody_ ? &newestBody_ : nullptr);
    if (open_) {
        const Nanoseconds before = clock_.now();
        const bool refused = !device_.write(tick.onHand);
        watchCall(before, "a write");
        if (refused && !std::exchange(refused_, true) && isGood(tick.state))
            notice_({.kind = DeviceNotice::Kind::Error,
                     .problem = text("the device refuses the force: ", device_.problem())});
        if (!refused) refused_ = false;
    }
    report(tick.state);
    energy_.store(tick.energy, std::memory_order_relaxed);
    ticks_.fetch_add(1, std::memory_order_relaxed);
    snapshot_.write({sampled_, sample_, tick, placed_});
}

void HapticServo::countWake(Nanoseconds late)
{
    const Nanoseconds bin = std::max<Nanoseconds>(0, late) / static_cast<Nanoseconds>(JitterHistogram::kWidth * 1e9);
    jitter_[static_cast<std::size_t>(std::min<Nanoseconds>(bin, JitterHistogram::kBins - 1))].fetch_add(
        1, std::memory_order_relaxed);
    storeMax(latest_, late);
}

void HapticServo::run(bool realTime)
{
    if (realTime) requestRealTime(1); // above physics, because a tick takes only microseconds
    const auto period = static_cast<Nanoseconds>(1e9 / loop_.def().rate);
    open();
    const Nanoseconds start = clock_.now();
    started_.store(start, std::memory_order_relaxed);
    for (Nanoseconds next = start + period; !stop_.load(std::memory_order_relaxed); next += period) {
        clock_.sleepUntil(next);
        const Nanoseconds now = clock_.now();
        countWake(now - next);
        lastWake_.store(now, std::memory_order_relaxed);
        if (now - next > period) next = now; // restart the grid instead of catching up with a burst of ticks
        tick(seconds(now - start));
    }
    close();
}

ServoStatistics HapticServo::statistics() const
{
    ServoStatistics all;
    all.ticks = ticks_.load(std::memory_order_relaxed);
    const double ran = seconds(lastWake_.load(std::memory_order_relaxed) - started_.load(std::memory_order_relaxed));
    for (std::size_t bin = 0; bin < jitter_.size(); ++bin)
        all.jitter.counts[bin] = jitter_[bin].load(std::memory_order_relaxed);
    if (ran > 0.0) all.rate = static_cast<double>(all.jitter.total()) / ran;
    all.latest = seconds(latest_.load(std::memory_order_relaxed));
    all.longestCall = seconds(longestCall_.load(std::memory_order_relaxed));
    all.energy = energy_.load(std::memory_order_relaxed);
    return all;
}

ServoClock steadyServoClock()
{
    ServoClock clock;
    clock.now = [] {
        timespec t{};
        clock_gettime(CLOCK_MONOTONIC, &t);
        return Nanoseconds{t.tv_sec} * kSecond + t.tv_nsec;
    };
    clock.sleepUntil = [](Nanoseconds time) {
        const timespec t{.tv_sec = time / kSecond, .tv_nsec = time % kSecond};
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) != 0) continue; // interrupted by a signal
    };
    return clock;
}

} // namespace filasofia::device
