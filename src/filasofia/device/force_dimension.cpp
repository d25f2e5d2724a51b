#include "filasofia/device/drivers.h"

#include "filasofia/core/error.h"
#include "filasofia/device/vendor_library.h"

#include <cmath>

namespace filasofia::device {
namespace {

// The part of libdhd's C interface (Force Dimension SDK 3.x) that is used here. A result < 0 is an error.
struct Dhd {
    explicit Dhd(const std::string& path)
    {
        const VendorLibrary library("device forcedimension", path, "libdhd.so.3");
        library.get("dhdGetDeviceCount", deviceCount);
        library.get("dhdOpenID", openId);
        library.get("dhdClose", close);
        library.get("dhdEnableForce", enableForce);
        library.get("dhdGetStatus", getStatus);
        library.get("dhdGetPositionAndOrientationFrame", getPose);
        library.get("dhdGetLinearVelocity", getVelocity);
        library.get("dhdGetAngularVelocityRad", getAngularVelocity);
        library.get("dhdGetButtonMask", getButtons);
        library.get("dhdHasWrist", hasWrist);
        library.get("dhdHasActiveWrist", hasActiveWrist);
        library.get("dhdSetForce", setForce);
        library.get("dhdSetForceAndTorque", setForceAndTorque);
        library.get("dhdErrorGetLastStr", lastError);
    }

    int (*deviceCount)();
    int (*openId)(char);
    int (*close)(char);
    int (*enableForce)(unsigned char, char);
    int (*getStatus)(int*, char);
    int (*getPose)(double*, double*, double*, double[3][3], char);
    int (*getVelocity)(double*, double*, double*, char);
    int (*getAngularVelocity)(double*, double*, double*, char);
    unsigned int (*getButtons)(char);
    bool (*hasWrist)(char);
    bool (*hasActiveWrist)(char);
    int (*setForce)(double, double, double, char);
    int (*setForceAndTorque)(double, double, double, double, double, double, char);
    const char* (*lastError)();
};

constexpr int kStatusPlaces = 64; // 12 to 17 in the versions so far
constexpr int kConnected = 1, kNeedsCalibration = 3, kError = 9;
constexpr int kStatusEvery = 50; // readings between two status queries

// The device's x axis points to the user, y to the right, z up. Ours, as everywhere: x to the right, y up.
Vec3 ours(Vec3 v) { return {v.y, v.z, v.x}; }
Vec3 theirs(Vec3 v) { return {v.z, v.x, v.y}; }

class ForceDimensionDriver final : public HapticDevice {
public:
    ForceDimensionDriver(int index, const std::string& library) : dhd_(library), index_(index) {}
    ~ForceDimensionDriver() override { ForceDimensionDriver::close(); }

    [[nodiscard]] std::string name() const override { return "forcedimension"; }

    void open() override
    {
        close();
        const int count = dhd_.deviceCount();
        if (index_ >= count)
            fail("device forcedimension: index must be < ", count < 0 ? 0 : count,
                 " (the number of connected devices), got ", index_);
        const int id = dhd_.openId(static_cast<char>(index_));
        if (id < 0) fail("device forcedimension: cannot be opened: ", said());
        id_ = static_cast<char>(id);
        open_ = true;
        readings_ = 0;
        status_ = DeviceStatus::Ready;
        if (dhd_.enableForce(1, id_) < 0) fail("device forcedimension: its force output cannot be enabled: ", said());
    }
    void close() noexcept override
    {
        if (!open_) return;
        open_ = false;
        dhd_.setForce(0.0, 0.0, 0.0, id_);
        dhd_.enableForce(0, id_);
        dhd_.close(id_);
    }
    [[nodiscard]] Capabilities capabilities() const override
    {
        return {.orientation = open_ && dhd_.hasWrist(id_),
                .force = true,
                .torque = open_ && dhd_.hasActiveWrist(id_),
                .buttons = 32};
    }
    DeviceSample read(double) noexcept override
    {
        DeviceSample sample{.status = status()};
        if (sample.status == DeviceStatus::Lost || sample.status == DeviceStatus::Failed) return sample;
        Vec3 p, v, w;
        double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        if (dhd_.getPose(&p.x, &p.y, &p.z, r, id_) < 0 || dhd_.getVelocity(&v.x, &v.y, &v.z, id_) < 0) {
            sample.status = failed();
            return sample;
        }
        if (dhd_.getAngularVelocity(&w.x, &w.y, &w.z, id_) < 0) w = {}; // a device without a wrist
        const Mat3 turn{{{r[0][0], r[0][1], r[0][2]}, {r[1][0], r[1][1], r[1][2]}, {r[2][0], r[2][1], r[2][2]}}};
        // The columns are the images of the axes: convert each of them, and their order, to our axes.
        const Mat3 oursTurn = Mat3::columns(ours(turn.column(1)), ours(turn.column(2)), ours(turn.column(0)));
        sample.hand = {{ours(p), toQuat(oursTurn)}, ours(v), ours(w)};
        sample.buttons = dhd_.getButtons(id_);
        return sample;
    }
    bool write(const CouplingForce& onHand) noexcept override
    {
        if (!open_) return true;
        const Vec3 f = theirs(onHand.force), t = theirs(onHand.torque);
        const int result = onHand.torque == Vec3{} ? dhd_.setForce(f.x, f.y, f.z, id_)
                                                   : dhd_.setForceAndTorque(f.x, f.y, f.z, t.x, t.y, t.z, id_);
        return result >= 0; // a result > 0 is a remark, such as a motor at its limit
    }
    [[nodiscard]] std::string problem() const override { return said(); }

private:
    [[nodiscard]] std::string said() const
    {
        const char* words = dhd_.lastError();
        return words ? oneLine(words) : "";
    }
    DeviceStatus failed() noexcept
    {
        int states[kStatusPlaces] = {};
        const bool there = dhd_.getStatus(states, id_) >= 0 && states[kConnected] != 0;
        return status_ = there ? DeviceStatus::Failed : DeviceStatus::Lost;
    }
    DeviceStatus status() noexcept
    {
        const bool wrong = status_ != DeviceStatus::Ready;
        if (!wrong && readings_++ % kStatusEvery != 0) return status_;
        int states[kStatusPlaces] = {};
        if (dhd_.getStatus(states, id_) < 0 || states[kConnected] == 0) return status_ = DeviceStatus::Lost;
        if (states[kError] != 0) return status_ = DeviceStatus::Failed;
        return status_ = states[kNeedsCalibration] != 0 ? DeviceStatus::NotCalibrated : DeviceStatus::Ready;
    }

    Dhd dhd_;
    int index_;
    char id_ = 0;
    bool open_ = false;
    long readings_ = 0;
    DeviceStatus status_ = DeviceStatus::Ready;
};

} // namespace

std::unique_ptr<HapticDevice> makeForceDimension(const ForceDimensionDevice& def, const std::string& library)
{
    return std::make_unique<ForceDimensionDriver>(def.index, library);
}

} // namespace filasofia::device
