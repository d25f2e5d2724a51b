#pragma once

#include "filasofia/core/output_file.h"
#include "filasofia/device/haptic_device.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The motion of a hand: generated, or recorded from a device, and played back.
namespace filasofia::device {

struct MotionSample {
    double time = 0.0; ///< [s]
    Pose pose = {};
    std::uint32_t buttons = 0;
};

/// A smooth path through samples. Positions follow a monotone cubic in each coordinate (Fritsch and Butland 1984): the
/// path never overshoots its samples, and a coordinate that is equal at two neighbouring samples stays constant between
/// them. Rotations take the short way at a constant rate between two samples; buttons are those of the last sample.
class Motion {
public:
    /// Throws an Error naming `object` and the sample unless there is at least one sample, times increase, numbers are
    /// finite, positions lie within 10 m, and orientations have a length.
    Motion(std::vector<MotionSample> samples, const std::string& object);

    /// The sample at `time`: the first sample before the start and the last one after the end; if `loop`, the motion
    /// repeats.
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

/// Writes a motion file.
class MotionWriter {
public:
    explicit MotionWriter(const std::string& file); ///< throws an Error if the file cannot be opened
    void write(const MotionSample& sample);         ///< samples that are not later than the last one are skipped
    void close();                                   ///< throws an Error if writing failed

private:
    std::unique_ptr<OutputFile> out_;
    std::optional<double> last_;
};

} // namespace filasofia::device
