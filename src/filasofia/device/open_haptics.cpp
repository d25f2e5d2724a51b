#include "filasofia/device/drivers.h"

#include "filasofia/core/error.h"
#include "filasofia/device/latest.h"
#include "filasofia/device/vendor_library.h"

#include <chrono>
#include <mutex>
#include <thread>

namespace filasofia::device {
namespace {

using Handle = unsigned int;
struct HdError {
    unsigned int code;
    int internal;
    Handle handle;
};
using Callback = unsigned int (*)(void*);

// The part of libHD's C interface (OpenHaptics 3.x) that is used here, with its constants.
struct Hd {
    explicit Hd(const std::string& path)
    {
        const VendorLibrary library("device openhaptics", path, "libHD.so.3");
        library.get("hdInitDevice", initDevice);
        library.get("hdDisableDevice", disableDevice);
        library.get("hdMakeCurrentDevice", makeCurrent);
        library.get("hdBeginFrame", beginFrame);
        library.get("hdEndFrame", endFrame);
        library.get("hdGetError", getError);
        library.get("hdGetErrorString", errorString);
        library.get("hdEnable", enable);
        library.get("hdGetDoublev", getDoubles);
        library.get("hdGetIntegerv", getIntegers);
        library.get("hdSetDoublev", setDoubles);
        library.get("hdCheckCalibration", checkCalibration);
        library.get("hdUpdateCalibration", updateCalibration);
        library.get("hdStartScheduler", startScheduler);
        library.get("hdStopScheduler", stopScheduler);
        library.get("hdScheduleAsynchronous", schedule);
        library.get("hdUnschedule", unschedule);
    }

    Handle (*initDevice)(const char*);
    void (*disableDevice)(Handle);
    void (*makeCurrent)(Handle);
    void (*beginFrame)(Handle);
    void (*endFrame)(Handle);
    HdError (*getError)();
    const char* (*errorString)(unsigned int);
    void (*enable)(unsigned int);
    void (*getDoubles)(unsigned int, double*);
    void (*getIntegers)(unsigned int, int*);
    void (*setDoubles)(unsigned int, const double*);
    unsigned int (*checkCalibration)();
    void (*updateCalibration)(unsigned int);
    void (*startScheduler)();
    void (*stopScheduler)();
    unsigned long (*schedule)(Callback, void*, unsigned short);
    void (*unschedule)(unsigned long);
};

constexpr Handle kNoHandle = 0xFFFFFFFF;
constexpr unsigned int kButtons = 0x2000, kVelocity = 0x2051, kTransform = 0x2052, kAngularVelocity = 0x2053;
constexpr unsigned int kCalibrationStyle = 0x2555, kMaxForce = 0x2603, kForce = 0x2700, kForceOutput = 0x4000;
constexpr unsigned int kDeviceFault = 0x0300, kCommunicationError = 0x0302;
constexpr unsigned int kCalibrated = 0x5000, kNeedsUpdate = 0x5001;
constexpr unsigned int kContinue = 1;
constexpr unsigned short kHighestPriority = 0xFFFF;
constexpr int kCalibrationEvery = 500; // frames of the library between two checks
constexpr int kSilence = 50;           // frames without a new force after which the force is zero
constexpr double kStandstill = 0.05;   // [s] without a frame after which the device counts as failed
constexpr double kMillimetre = 1e-3;

/// All devices share the library's single scheduler, which must be stopped while a device is opened.
struct Scheduler {
    std::mutex mutex;
    int devices = 0;
};
Scheduler& scheduler()
{
    static Scheduler one;
    return one;
}

/// The result of one frame of the library's servo loop.
struct FrameSample {
    DeviceSample device = {};
    std::uint64_t frame = 0;
    unsigned int error = 0;
};

/// The library's own loop reads and writes the device; this driver only passes the data on. It adds at most one of
/// the library's frames of delay.
class OpenHapticsDriver final : public HapticDevice {
public:
    OpenHapticsDriver(std::string device, const std::string& library) : hd_(library), device_(std::move(device)) {}
    ~OpenHapticsDriver() override { OpenHapticsDriver::close(); }

    [[nodiscard]] std::string name() const override { return "openhaptics"; }

    void open() override
    {
        close();
        Scheduler& shared = scheduler();
        const std::lock_guard lock(shared.mutex);
        if (shared.devices > 0) hd_.stopScheduler();
        handle_ = hd_.initDevice(device_.empty() ? nullptr : device_.c_str());
        const HdError problem = hd_.getError();
        if (handle_ == kNoHandle || problem.code != 0) {
            handle_ = kNoHandle;
            if (shared.devices > 0) hd_.startScheduler();
            fail("device openhaptics: '", device_.empty() ? "default" : device_,
                 "' cannot be opened: ", said(problem.code));
        }
        ++shared.devices;
        hd_.enable(kForceOutput);
        double reported = 0.0;
        hd_.getDoubles(kMaxForce, &reported);
        maxForce_ = reported > 0.0 ? reported : maxForce_;
        sinceOpened_ = 0;
        const std::uint64_t before = frame_; // its loop is stopped
        seenAt_.reset();
        command_.write({{}, ++commands_});
        task_ = hd_.schedule([](void* self) { return static_cast<OpenHapticsDriver*>(self)->frame(); }, this,
                             kHighestPriority);
        hd_.startScheduler();
        awaitFrame(before);
    }
    void close() noexcept override
    {
        if (handle_ == kNoHandle) return;
        Scheduler& shared = scheduler();
        const std::lock_guard lock(shared.mutex);
        hd_.stopScheduler();
        hd_.unschedule(task_);
        hd_.disableDevice(handle_); // this leaves no force
        handle_ = kNoHandle;
        if (--shared.devices > 0) hd_.startScheduler();
    }
    /// Torque exists only on a few models, in a unit of its own, so it is not used.
    [[nodiscard]] Capabilities capabilities() const override
    {
        return {.orientation = true, .force = true, .buttons = 4, .forceLimit = maxForce_};
    }
    DeviceSample read(double time) noexcept override
    {
        static_cast<void>(sample_.read(now_));
        if (now_.frame != seen_ || !seenAt_) {
            seen_ = now_.frame;
            seenAt_ = time;
        }
        DeviceSample out = now_.device;
        if (time - *seenAt_ > kStandstill) out.status = DeviceStatus::Failed;
        return out;
    }
    bool write(const CouplingForce& onHand) noexcept override
    {
        command_.write({onHand.force, ++commands_});
        return true;
    }
    [[nodiscard]] std::string problem() const override
    {
        if (now_.error != 0) return said(now_.error);
        return now_.device.status == DeviceStatus::Ready ? "its servo loop has stopped" : "";
    }

private:
    struct Command {
        Vec3 force = {};
        std::uint64_t number = 0;
    };

    /// Waits for the first frame: until then there is nothing to read but the old sample.
    void awaitFrame(std::uint64_t before)
    {
        constexpr int attempts = 1000; // about a second
        for (int i = 0; i < attempts; ++i) {
            if (sample_.read(now_) && now_.frame > before) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        fail("device openhaptics: its servo loop did not start within a second");
    }

    [[nodiscard]] std::string said(unsigned int code) const
    {
        const char* words = hd_.errorString(code);
        return words ? oneLine(words) : text("error ", code);
    }

    /// Runs on the library's thread, once a millisecond.
    unsigned int frame() noexcept
    {
        hd_.makeCurrent(handle_);
        hd_.beginFrame(handle_);
        FrameSample sample{.frame = ++frame_};
        double m[16] = {}, v[3] = {}, w[3] = {};
        int buttons = 0;
        hd_.getDoubles(kTransform, m); // column-major, millimetres
        hd_.getDoubles(kVelocity, v);
        hd_.getDoubles(kAngularVelocity, w);
        hd_.getIntegers(kButtons, &buttons);
        sample.device.hand = {{kMillimetre * Vec3{m[12], m[13], m[14]},
                               toQuat(Mat3::columns({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}))},
                              kMillimetre * Vec3{v[0], v[1], v[2]},
                              {w[0], w[1], w[2]}};
        sample.device.buttons = static_cast<std::uint32_t>(buttons);

        Command command = lastCommand_;
        static_cast<void>(command_.read(command));
        silent_ = command.number == lastCommand_.number ? silent_ + 1 : 0;
        lastCommand_ = command;
        const Vec3 f = silent_ > kSilence ? Vec3{} : command.force;
        const double force[3] = {f.x, f.y, f.z};
        hd_.setDoubles(kForce, force);
        hd_.endFrame(handle_);

        if (sinceOpened_++ % kCalibrationEvery == 0) calibrated_ = calibrate();
        sample.error = hd_.getError().code;
        sample.device.status = sample.error == kCommunicationError || sample.error == kDeviceFault ? DeviceStatus::Lost
                               : sample.error != 0 ? DeviceStatus::Failed
                               : calibrated_       ? DeviceStatus::Ready
                                                   : DeviceStatus::NotCalibrated;
        sample_.write(sample);
        return kContinue;
    }
    bool calibrate() noexcept
    {
        unsigned int answer = hd_.checkCalibration();
        if (answer == kNeedsUpdate) {
            int style = 0;
            hd_.getIntegers(kCalibrationStyle, &style);
            hd_.updateCalibration(static_cast<unsigned int>(style));
            answer = hd_.checkCalibration();
        }
        return answer == kCalibrated;
    }

    Hd hd_;
    std::string device_;
    Handle handle_ = kNoHandle;
    unsigned long task_ = 0;
    double maxForce_ = 3.3; ///< [N], a Touch's value, used if the library does not report one

    // Used by the library's thread.
    std::uint64_t frame_ = 0, sinceOpened_ = 0;
    int silent_ = 0;
    bool calibrated_ = false;
    Command lastCommand_;

    // Used by the servo's thread.
    FrameSample now_;
    std::uint64_t seen_ = 0, commands_ = 0;
    std::optional<double> seenAt_;

    Latest<FrameSample> sample_;
    Latest<Command> command_;
};

} // namespace

std::unique_ptr<HapticDevice> makeOpenHaptics(const OpenHapticsDevice& def, const std::string& library)
{
    return std::make_unique<OpenHapticsDriver>(def.device, library);
}

} // namespace filasofia::device
