#include "filasofia/device/devices.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>

namespace motion_test {

using namespace filasofia;
using namespace filasofia::device;

namespace {

struct MotionFile {
    explicit MotionFile(const std::string& text = {})
    {
        if (!text.empty()) std::ofstream(path) << text;
    }
    ~MotionFile() { std::filesystem::remove(path); }
    std::string path =
        (std::filesystem::temp_directory_path() / ("filasofia_motion_test_" + std::to_string(getpid()))).string();
};

constexpr const char* kHeader = "time,x,y,z,qw,qx,qy,qz,buttons\n";

std::string refusal(const std::string& lines)
{
    const MotionFile file(lines);
    try {
        readMotion(file.path);
    } catch (const Error& error) {
        std::string said = error.what();
        if (const auto at = said.find(file.path); at != std::string::npos) said.replace(at, file.path.size(), "FILE");
        return said;
    }
    return "nothing";
}

} // namespace

TEST_CASE("a motion goes through its samples, without a jump and without overshooting")
{
    const Motion motion({{0.0, {{0, 0, 0}, {}}, 0},
                         {1.0, {{0.1, 0, 0}, axisAngle({0, 0, 1}, 0.5)}, 1},
                         {2.0, {{0.1, 0, 0}, axisAngle({0, 0, 1}, 0.5)}, 3},
                         {4.0, {{0, 0.2, 0}, {}}, 0}},
                        "motion");
    CHECK(motion.duration() == 4.0);
    for (const MotionSample& sample : motion.samples()) {
        const DeviceSample at = motion.at(sample.time);
        CHECK(distance(at.hand.pose.position, sample.pose.position) < 1e-15);
        CHECK(at.buttons == sample.buttons);
    }
    const double h = 1e-6;
    for (double t = 0.01; t < 3.99; t += 0.01) {
        const MotionState at = motion.at(t).hand;
        CHECK(distance((motion.at(t + h).hand.pose.position - motion.at(t - h).hand.pose.position) / (2 * h),
                       at.velocity) < 1e-6);
        CHECK(at.pose.position.x >= 0.0);
        CHECK(at.pose.position.x <= 0.1);
        if (t > 1.001 && t < 1.999) CHECK(at.pose.position == Vec3{0.1, 0, 0});
    }
    CHECK(motion.at(0.5).hand.angularVelocity.z == Approx(0.5));
    CHECK(length(rotationVector(motion.at(0.5).hand.pose.orientation)) == Approx(0.25));
    CHECK(motion.at(-1.0).hand.pose.position == Vec3{});
    CHECK(motion.at(9.0).hand == MotionState{{{0, 0.2, 0}, {}}, {}, {}});
    CHECK(motion.at(5.0, true).buttons == 1); // one second into the second repetition
}

TEST_CASE("a motion that was written is read again to the same bits")
{
    const MotionFile file;
    std::vector<MotionSample> samples;
    MotionWriter writer(file.path);
    for (int i = 0; i < 50; ++i)
        samples.push_back({i / 3.0, {{std::sin(i), i / 7.0 * 0.1, -0.01}, axisAngle({1, 2, 3}, i)}, i % 3 ? 0u : 5u});
    for (const MotionSample& sample : samples) writer.write(sample);
    writer.write(samples.back()); // not later than the last one
    writer.close();
    const Motion read = readMotion(file.path);
    REQUIRE(read.samples().size() == samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        CHECK(read.samples()[i].time == samples[i].time);
        CHECK(read.samples()[i].pose.position == samples[i].pose.position);
        CHECK(std::abs(dot(read.samples()[i].pose.orientation, samples[i].pose.orientation)) == Approx(1.0));
        CHECK(read.samples()[i].buttons == samples[i].buttons);
    }
}

TEST_CASE("a motion file that is being written is not written by another one")
{
    const MotionFile file;
    MotionWriter writer(file.path);
    CHECK_THROWS_WITH(MotionWriter(file.path),
                      "motion file " + file.path + ": is already being written, under this or another name");
    writer.close();
    CHECK_NOTHROW(MotionWriter(file.path));
}

TEST_CASE("an invalid motion file is refused with file, line, field and value")
{
    const std::string head = kHeader;
    CHECK(refusal("") == "motion file 'FILE': no such file"); // it was not written
    CHECK(refusal(head) == "motion file 'FILE': must have at least one sample, got none");
    CHECK(refusal("# nothing\n" + head + "# nothing\n") ==
          "motion file 'FILE': must have at least one sample, got none");
    CHECK(refusal("0,0,0\n") == "motion file 'FILE': line 1: must be 'time,x,y,z,qw,qx,qy,qz,buttons', got '0,0,0'");
    CHECK(refusal(head + "0,0,0,0,1,0,0,0,0\n0,0,0,0,1,0,0,0,0\n") ==
          "motion file 'FILE': line 3: time must be > 0 s (the time of the previous sample), got 0");
    CHECK(refusal(head + "# a remark\n0,0,0,0,1,0,0,0,0\n-1,0,0,0,1,0,0,0,0\n") ==
          "motion file 'FILE': line 4: time must be > 0 s (the time of the previous sample), got -1");
    CHECK(refusal(head + "0,nan,0,0,1,0,0,0,0\n") ==
          "motion file 'FILE': line 2: the position x, y, z must lie within 10 m of the origin, got nan 0 0");
    CHECK(refusal(head + "inf,0,0,0,1,0,0,0,0\n") == "motion file 'FILE': line 2: time must be finite, got inf");
    CHECK(refusal(head + "0,0,0,0,0,0,0,0,0\n") ==
          "motion file 'FILE': line 2: the quaternion qw, qx, qy, qz must have a length > 1e-06, got 0");
    CHECK(refusal(head + "0,0,0,0,1,0,0,0\n") == "motion file 'FILE': line 2: must have 9 numbers, got 8");
    CHECK(refusal(head + "0,0,zero,0,1,0,0,0,0\n") ==
          "motion file 'FILE': line 2: must be 9 numbers, the last one whole and >= 0, got '0,0,zero,0,1,0,0,0,0'");
    CHECK(refusal(head + "0,0,0,0,1,0,0,0,-1\n").find("the last one whole") != std::string::npos);
    CHECK(refusal(head + "0,0,0,0,1,0,0,0,0,\n") == "motion file 'FILE': line 2: must have 9 numbers, got 10");
    CHECK(refusal(head + "0,0,0,0,1,0,0,0,0\r\n1, 0.1,0,0,1,0,0,0,0") == "nothing"); // spaces, other line ends
}

TEST_CASE("a motion file that never ends, or would make the reader wait, is refused")
{
    CHECK_THROWS_WITH(readMotion("/dev/zero"), "motion file '/dev/zero': must be a regular file or a pipe");
    CHECK_THROWS_WITH(readMotion("/tmp"), "motion file '/tmp': must be a file, got a directory");
    CHECK(refusal(text(std::string(5000, '#'), "\n", kHeader)) ==
          "motion file 'FILE': line 1: must have at most 4096 bytes, got more");
    CHECK(refusal(text(kHeader, "0,0,0,0,1,0,0,0,0\n", std::string(1 << 20, '\0'))) ==
          "motion file 'FILE': line 3: must have at most 4096 bytes, got more");
}

TEST_CASE("devices are made by name, and invalid Defs are refused")
{
    CHECK(nameOf(deviceNamed("spacemouse")) == "spacemouse");
    CHECK_THROWS_WITH(deviceNamed("omega"), "device: must be one of mouse, gamepad, spacemouse, scripted, "
                                            "forcedimension, openhaptics, got 'omega'");
    CHECK_THROWS_WITH(makeDevice(ScriptedDevice{}),
                      "device scripted: motion must be the name of a file or a motion, got none");
    CHECK_THROWS_WITH(makeDevice(ScriptedDevice{"/nowhere.csv"}), "motion file '/nowhere.csv': no such file");
    CHECK_THROWS_WITH(makeDevice(MouseDevice{}, "libx.so"),
                      "device mouse: library must be empty, because this device needs none; got 'libx.so'");
    CHECK_THROWS_WITH(makeDevice(MouseDevice{.reach = 0.0}), "device mouse: reach must be > 0 m, got 0");
    CHECK_THROWS_WITH(makeDevice(ForceDimensionDevice{.index = 16}),
                      "device forcedimension: index must be in [0, 15], got 16");
    CHECK_THROWS_WITH(makeDevice(OpenHapticsDevice{}, "/nowhere/libHD.so"),
                      Catch::Contains("device openhaptics: library '/nowhere/libHD.so' cannot be opened: "));
}

} // namespace motion_test
