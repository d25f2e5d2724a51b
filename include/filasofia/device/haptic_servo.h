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

/// Where the servo gets its time from; a test gives it another.
struct ServoClock {
    std::function<Nanoseconds()> now;
    std::function<void(Nanoseconds)> sleepUntil; ///< returns at that time or later
};

/// What happened to a device.
struct DeviceNotice {
    enum class Kind {
        Connected, ///< it was opened, or is right again
        Lost,      ///< it is gone
        Error,     ///< it is there, and something is wrong with it
        Button     ///< one went down or up
    };
    Kind kind = Kind::Connected;
    std::string problem = {}; ///< in one line; empty for the other kinds
    int button = 0;           ///< [-], in [0, 32)
    bool pressed = false;
};

/// What a servo has done, for whoever watches it.
struct ServoSnapshot {
    Nanoseconds time = 0;      ///< of the sample
    DeviceSample sample = {};  ///< along the device's axes
    ServoTick tick = {};       ///< what it led to
    std::uint64_t placing = 0; ///< by which place() the hand was seen in the scene; 0: by the Def
};

/// Wake-ups by how late they were.
struct JitterHistogram {
    static constexpr int kBins = 256;
    static constexpr double kWidth = 10e-6; ///< [s] of a bin; the last has all that are later
    std::array<std::uint64_t, kBins> counts = {};

    [[nodiscard]] std::uint64_t total() const;
    /// [s], a bin's upper end: so late at most were this share of the wake-ups. 0 where there were none; infinite where
    /// it is in the last bin.
    [[nodiscard]] double percentile(double share) const;
};

struct ServoStatistics {
    std::uint64_t ticks = 0;
    double rate = 0.0;        ///< [Hz], mean since the start
    double latest = 0.0;      ///< [s], of all wake-ups, the lateness of the latest
    double longestCall = 0.0; ///< [s], that the device took to be read or written
    double energy = 0.0;      ///< [J] net, that the hand was given
    JitterHistogram jitter = {};
};

/// A device and its servo loop: on a thread of its own that ticks at its rate, whatever physics does, or tick by tick
/// in a caller's hand. Physics hands in the body's states and takes samples, and waits for nothing.
class HapticServo {
public:
    /// `device` outlives the servo. `notice` is called on the thread that ticks. Throws an Error where the Def is
    /// wrong.
    HapticServo(HapticDevice& device, const ServoDef& def, ServoClock clock,
                std::function<void(const DeviceNotice&)> notice);
    ~HapticServo(); ///< stops, and closes the device
    HapticServo(const HapticServo&) = delete;
    HapticServo& operator=(const HapticServo&) = delete;

    /// Begins to tick on an own thread; `realTime`: it asks to be scheduled before physics. The device is opened there:
    /// that may take long, or fail; then it is tried again every second.
    void start(bool realTime);
    void stop(); ///< and leaves no force on the hand

    // Tick by tick, without a thread.
    void open();            ///< as start() does it: what fails is a notice
    void tick(double time); ///< where the hand is, and what it feels; `time` [s] is the device's
    void close();

    /// Every sample of a device that is ready goes there too, to be read by one thread. Before it starts.
    void record(SpscRing<MotionSample>* tape) { tape_ = tape; }

    void setBody(const BodySample& body) { body_.write(body); }                         ///< one thread
    [[nodiscard]] bool latest(ServoSnapshot& out) const { return snapshot_.read(out); } ///< any thread
    [[nodiscard]] ServoStatistics statistics() const;                                   ///< any thread
    /// Another place of the device in the scene, from the next tick on. Any thread. Returns the number of the placing.
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
    void tell(ServoState state);
    void tellButtons(std::uint32_t buttons);
    void watchCall(Nanoseconds before, const char* call);
    void reopenAfterAWhile();
    void countWake(Nanoseconds late);

    HapticDevice& device_;
    ServoLoop loop_;
    ServoClock clock_;
    std::function<void(const DeviceNotice&)> notice_;
    bool open_ = false;
    std::optional<ServoState> told_ = {}; ///< what is wrong, and was told
    bool slow_ = false;                   ///< a call took too long; told
    bool refused_ = false;                ///< the last write was
    std::uint32_t buttons_ = 0;
    Nanoseconds tryAgain_ = 0; ///< to open it
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

/// The machine's steady clock; sleeps to absolute times.
ServoClock steadyServoClock();

} // namespace filasofia::device
