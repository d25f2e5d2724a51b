#pragma once

#include "filasofia/device/haptic_device.h"

#include <fstream>
#include <optional>
#include <string>
#include <vector>

/// What a hand did: made without hardware, or recorded from a device and played back.
namespace filasofia::device {

struct MotionSample {
    double time = 0.0; ///< [s]
    Pose pose = {};
    std::uint32_t buttons = 0;
};

/// A smooth path through samples. Places follow a monotone cubic through each coordinate (Fritsch and Butland 1984): it
/// never swings beyond its samples, and what rests between two of them rests. Turns go the short way, at a constant
/// rate between two samples; a button is as the last sample says.
class Motion {
public:
    /// Throws an Error naming `object` and the sample: at least one, times that rise, numbers that are finite, places
    /// within 10 m, orientations that have a length.
    Motion(std::vector<MotionSample> samples, const std::string& object);

    /// Before the first sample it is there, after the last it rests there; `loop`: it begins anew.
    [[nodiscard]] DeviceSample at(double time, bool loop = false) const;
    [[nodiscard]] double duration() const { return samples_.back().time - samples_.front().time; } ///< [s]
    [[nodiscard]] const std::vector<MotionSample>& samples() const { return samples_; }

private:
    std::vector<MotionSample> samples_;
    std::vector<Vec3> slopes_; ///< [m/s] per sample
};

/// Reads a motion file: a table whose first line is "time,x,y,z,qw,qx,qy,qz,buttons", then one line per sample, in
/// seconds and metres along the device's axes. Lines that begin with '#' are comments. Errors name file and line.
Motion readMotion(const std::string& file);

/// Writes one.
class MotionWriter {
public:
    explicit MotionWriter(const std::string& file); ///< Error where it cannot be written
    void write(const MotionSample& sample);         ///< those that do not come later than the last are left out
    void close();                                   ///< Error where the disk refused something

private:
    std::string file_;
    std::ofstream out_;
    std::optional<double> last_;
};

} // namespace filasofia::device
