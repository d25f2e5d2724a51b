#pragma once

#include "filasofia/device/latest.h"
#include "filasofia/device/motion.h"
#include "filasofia/device/servo_loop.h"

#include "filasofia/core/spsc_ring.h"

#include <array>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace filasofia::device {

/// The servo's time source; a test provides its own.
struct ServoClock {
    std::function<Nanoseconds()> now;
    std::function<void(Nanoseconds)> sleepUntil; ///< returns at that time or later
};

/// A notice about a device.
struct DeviceNotice {
    enum class Kind {
        Connected, ///< it was opened, or works again
        Lost,      ///< it is gone
        Error,     ///< it is connected, but something is wrong with it
        Button     ///< a button was pressed or released
    };
    Kind kind = Kind::Connected;
    std::string problem = {}; ///< one line; empty for the other kinds
    int button = 0;           ///< [-], in [0, 32)
    bool pressed = false;
};

/// The latest state of a servo, for monitoring.
struct ServoSnapshot {
    Nanoseconds time = 0;      ///< time of the sample
    DeviceSample sample = {};  ///< along the device's axes
    ServoTick tick = {};       ///< the result of the tick
    std::uint64_t placing = 0; ///< number of the place() call that positioned the device in the scene; 0: the Def
};

/// A histogram of how late the wake-ups were.
struct JitterHistogram {
    static constexpr int kBins = 256;
    static constexpr double kWidth = 10e-6; ///< [s] width of a bin; the last bin counts all that were later
    std::array<std::uint64_t, kBins> counts = {};

    [[nodiscard]] std::uint64_t total() const;
    /// [s], upper end of a bin: this share of the wake-ups was at most so late. 0 if there were no wake-ups; infinite
    /// if the value lies in the last bin.
    [[nodiscard]] double percentile(double share) const;
};

struct ServoStatistics {
    std::uint64_t ticks = 0;
    double rate = 0.0;        ///< [Hz], mean since the start
    double latest = 0.0;      ///< [s], the largest lateness of a wake-up
    double longestCall = 0.0; ///< [s], the longest time that a read or a write of the device took
    double energy = 0.0;      ///< [J] net energy given to the hand
    JitterHistogram jitter = {};
};

/// A device and its servo loop, either on a thread of its own that ticks at its own rate independently of physics, or
/// called tick by tick. Physics sets the body's states and takes samples, and waits for nothing.
class HapticServo {
public:
    /// `device` must outlive the servo. `notice` is called on the ticking thread. Throws an Error if the Def is
    /// invalid.
    HapticServo(HapticDevice& device, const ServoDef& def, ServoClock clock,
                std::function<void(const DeviceNotice&)> notice);
    ~HapticServo(); ///< stops, and closes the device
    HapticServo(const HapticServo&) = delete;
    HapticServo& operator=(const HapticServo&) = delete;

    /// Starts ticking on a thread of its own; if `realTime`, with a higher real-time priority than physics. That thread
    /// opens the device, which may take long or fail; then it tries again every second.
    void start(bool realTime);
    void stop(); ///< stops the thread and leaves no force on the hand

    // Tick by tick, without a thread.
    void open();            ///< as start() does: a failure is reported as a notice
    void tick(double time); ///< reads the hand and writes its force; `time` [s] is the device's
    void close();

    /// Records every sample of a device that is ready, for one reading thread. To be called before the start.
    void record(SpscRing<MotionSample>* tape) { tape_ = tape; }

    void setBody(const BodySample& body) { body_.write(body); }                         ///< one thread
    [[nodiscard]] bool latest(ServoSnapshot& out) const { return snapshot_.read(out); } ///< any thread
    [[nodiscard]] ServoStatistics statistics() const;                                   ///< any thread
    /// Changes the device's placement in the scene, from the next tick on. Any thread. Returns the number of the
    /// placement.
    std::uint64_t place(double scale, const Pose& origin, Quat grip = {});

private:
    struct Placing {
        std::uint64_t number = 0;
        double scale = 1.0;
        Pose origin = {};
        Quat grip = {};
    };

    void run(bool realTime);
    void read(double time);
    void render();
    void takePlacing();
    void report(ServoState state);
    void reportButtons(std::uint32_t buttons);
    void watchCall(Nanoseconds before, const char* call);
    void reopenAfterAWhile();
    void countWake(Nanoseconds late);

    HapticDevice& device_;
    ServoLoop loop_;
    ServoClock clock_;
    std::function<void(const DeviceNotice&)> notice_;
    bool open_ = false;
    std::optional<ServoState> reported_ = {}; ///< what is wrong and was reported
    bool slow_ = false;                       ///< a call took too long, and this was reported
    bool refused_ = false;                    ///< the last write was refused
    std::uint32_t buttons_ = 0;
    Nanoseconds tryAgain_ = 0; ///< when to try to open it again
    DeviceSample sample_ = {};
    Nanoseconds sampled_ = 0;
    BodySample newestBody_ = {};
    bool hasBody_ = false;
    std::uint64_t placed_ = 0;
    SpscRing<MotionSample>* tape_ = nullptr;

    Latest<BodySample> body_;
    Latest<ServoSnapshot> snapshot_;
    Latest<Placing> placing_;
    std::mutex placingMutex_;
    std::uint64_t placings_ = 0;

    std::array<std::atomic<std::uint64_t>, JitterHistogram::kBins> jitter_ = {};
    std::atomic<std::uint64_t> ticks_ = 0;
    std::atomic<Nanoseconds> started_ = 0, lastWake_ = 0, latest_ = 0, longestCall_ = 0;
    std::atomic<double> energy_ = 0.0;

    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

/// The machine's steady clock; sleeps until absolute times.
ServoClock steadyServoClock();

} // namespace filasofia::device
