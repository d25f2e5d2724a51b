#include "filasofia/runtime/video_file.h"

#include "filasofia/filasofia.h"
#include "filasofia/runtime/replay.h"

#include "skip.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace video_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

namespace fs = std::filesystem;

/// A folder that replaces PATH except for the system's folders, with a program called ffmpeg in it.
class FakeFfmpeg {
public:
    explicit FakeFfmpeg(const std::string& script, const std::string& others = ":/usr/bin:/bin")
        : folder(fs::temp_directory_path() / text("filasofia_video_", getpid())), path_(std::getenv("PATH"))
    {
        fs::remove_all(folder);
        fs::create_directories(folder);
        if (!script.empty()) {
            std::ofstream(folder / "ffmpeg") << "#!/bin/sh\n" << script;
            chmod((folder / "ffmpeg").c_str(), 0755);
        }
        setenv("PATH", (folder.string() + others).c_str(), 1);
    }
    ~FakeFfmpeg()
    {
        setenv("PATH", path_.c_str(), 1);
        fs::remove_all(folder);
    }
    [[nodiscard]] std::string read(const std::string& name) const
    {
        std::ifstream file(folder / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    [[nodiscard]] std::string file(const std::string& name = "out.mp4") const { return (folder / name).string(); }

    fs::path folder;

private:
    std::string path_;
};

/// Writes its arguments, one per line, and its input into files beside itself.
const std::string kRecorder = R"(here=$(dirname "$0")
case "$*" in *-version*) exit 0;; esac
printf '%s\n' "$@" > "$here/arguments"
cat > "$here/input"
)";

/// Answers to -version, then does `what`.
std::string thenDoes(const std::string& what) { return "case \"$*\" in *-version*) exit 0;; esac\n" + what; }

visual::Image picture(int width, int height, std::uint8_t value)
{
    return {width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height), value)};
}

SimulationDef small() { return {.physics = {.gravity = {}}, .window = {.width = 32, .height = 16}}; }

} // namespace

TEST_CASE("ffmpeg gets raw pictures of the given size and rate, and the file by its name alone")
{
    const FakeFfmpeg ffmpeg(kRecorder);
    const std::string name = ffmpeg.file("-odd $(touch gone) name.mp4");
    VideoFile video(name, 5, 3, 24);
    video.show(picture(5, 3, 7), 3.0 / 24);
    video.close();
    const std::string arguments = ffmpeg.read("arguments");
    for (const char* line : {"rawvideo\n", "rgba\n", "-video_size\n5x3\n", "-framerate\n24\n", "pipe:0\n"})
        CHECK_THAT(arguments, Catch::Contains(line));
    CHECK_THAT(arguments, Catch::Contains("\nfile:" + name + "\n")); // no shell has interpreted it
    CHECK(ffmpeg.read("input") == std::string(3 * 4 * 5 * 3, 7));
}

TEST_CASE("a picture is written as often as it is due, and not before")
{
    const FakeFfmpeg ffmpeg(kRecorder);
    VideoFile video(ffmpeg.file(), 1, 1, 10);
    CHECK_FALSE(video.due(0.0));
    video.show(picture(1, 1, 1), 0.05);
    for (double time = 0.0; time < 0.1999; time += 0.02) video.show(picture(1, 1, 2), time); // due at 0.1
    video.show(picture(1, 1, 3), 0.5);
    video.close();
    CHECK(ffmpeg.read("input") == std::string(4, 2) + std::string(16, 3));
}

TEST_CASE("pictures of another size are cut off, or have black beside them")
{
    const FakeFfmpeg ffmpeg(kRecorder);
    VideoFile video(ffmpeg.file(), 2, 2, 1);
    video.show(picture(3, 1, 9), 1.0);
    video.show(picture(1, 5, 8), 2.0);
    video.close();
    CHECK(ffmpeg.read("input") == std::string(8, 9) + std::string(8, 0) + std::string(4, 8) + std::string(4, 0) +
                                      std::string(4, 8) + std::string(4, 0));
}

TEST_CASE("without ffmpeg, or with one that does not run, a video is refused before the run")
{
    Simulation sim(small());
    const auto run = [&](const std::string& file) {
        sim.run({.backend = Backend::Null, .steps = 5, .freeRunning = true, .video = file});
    };
    {
        const FakeFfmpeg none("", "");
        CHECK_THROWS_WITH(run(none.file()), "run: video needs the program ffmpeg, which is in no folder of PATH");
    }
    {
        const FakeFfmpeg dead("echo 'no libx264.so' >&2\nexit 127\n");
        CHECK_THROWS_WITH(run(dead.file()), Catch::Contains("does not run: no libx264.so (exit code 127)"));
    }
    CHECK_THROWS_WITH(run("/nowhere/at/all.mp4"), Catch::Contains("there is no such folder"));
    CHECK_THROWS_WITH(run("film.mkv"), "run: video must end in .mp4 or .avi, got 'film.mkv'");
    CHECK(sim.run({.headless = true, .steps = 1}).steps == 1); // nothing was stepped, and it can still run
}

TEST_CASE("if ffmpeg dies on the way or finds the disk full at the end, the run goes on and its report says so")
{
    Simulation sim(small());
    const auto problem = [](const RunReport& report) {
        CHECK_FALSE(report.complete());
        CHECK(report.pictures.empty());
        REQUIRE(report.fileProblems.size() == 1);
        CHECK_THAT(summary(report), Catch::Contains("incomplete: " + report.fileProblems[0]));
        return report.fileProblems[0];
    };
    {
        const FakeFfmpeg dying(
            thenDoes("head -c 100 > /dev/null\necho 'first' >&2\necho 'No space left on device' >&2\nexit 1\n"));
        const RunReport report = sim.run({.backend = Backend::Null, .steps = 500, .video = dying.file(), .fps = 240});
        CHECK(report.steps == 500);
        CHECK_THAT(problem(report),
                   Catch::Contains("No space left on device (exit code 1)") && Catch::Contains("video '"));
    }
    {
        const FakeFfmpeg late(thenDoes("cat > /dev/null\necho 'cannot write the trailer' >&2\nexit 3\n"));
        const RunDef run{.backend = Backend::Null, .steps = 5, .freeRunning = true, .video = late.file()};
        CHECK_THAT(problem(sim.run(run)), Catch::Contains("cannot write the trailer (exit code 3)"));
    }
    {
        const FakeFfmpeg killed(thenDoes("kill -9 $$\n"));
        VideoFile video(killed.file(), 1, 1, 1);
        CHECK_THROWS_WITH(video.close(), Catch::Contains("killed by signal 9"));
    }
}

TEST_CASE("a live run's video has the length of its wall time")
{
    const FakeFfmpeg ffmpeg(kRecorder);
    Simulation sim(small());
    const RunReport report = sim.run({.backend = Backend::Null, .seconds = 0.3, .video = ffmpeg.file(), .fps = 20});
    const double pictures = static_cast<double>(ffmpeg.read("input").size()) / (4.0 * 32 * 16);
    CHECK(pictures == std::floor(pictures));
    CHECK(pictures >= 5); // those due by 0.3 s, except the last; a slow machine makes the run longer, and so the video
    CHECK(report.pictures == std::vector<std::string>{ffmpeg.file()});
}

#ifdef FILASOFIA_HAS_FILAMENT
TEST_CASE("a headless run's video has a picture for each part of simulated time, whatever the steps")
{
    const FakeFfmpeg ffmpeg(kRecorder);
    Simulation sim({.physics = {.rate = 200, .gravity = {}}, .window = {.width = 32, .height = 16}});
    sim.show(sim.add(RigidBodyDef{.mesh = shapes::box({0.01, 0.01, 0.01})}));
    const auto pictures = [&] { return ffmpeg.read("input").size() / (4 * 32 * 16); };
    sim.run({.headless = true, .steps = 50, .video = ffmpeg.file(), .fps = 20}); // 0.25 s
    CHECK(pictures() == 5);
    sim.run({.headless = true, .steps = 4, .video = ffmpeg.file(), .fps = 240}); // 0.02 s: more pictures than steps
    CHECK(pictures() == 4);
}
#endif

TEST_CASE("a replay films what the run has filmed, picture by picture")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const FakeFfmpeg ffmpeg(kRecorder);
    Simulation sim({.window = {.width = 64, .height = 48}});
    const BodyId box = sim.add(RigidBodyDef{.mesh = shapes::box({0.02, 0.02, 0.02})});
    sim.show(box);
    visual::Camera* eye = nullptr;
    sim.dress([&](VisualServer& server) {
        eye = &server.add(CameraDef{});
        eye->setPose({{0, 0, 0.1}, {}});
        server.add(ViewDef{}, *eye);
    });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        sim.physics().setPose(box, {{1e-4 * static_cast<double>(update.step), 0, 0}, {}});
        eye->setPose({{0, 1e-4 * static_cast<double>(update.step), 0.1}, {}});
        if (update.step == 60) sim.show(box, {.surface = shapes::sphere(0.015), .material = MetalMaterial{}});
    });
    sim.run(
        {.headless = true, .steps = 100, .record = ffmpeg.file("run.rec"), .video = ffmpeg.file("run.mp4"), .fps = 50});
    const std::string filmed = ffmpeg.read("input");
    REQUIRE(filmed.size() >= 5u * 64 * 48 * 3);
    REQUIRE(filmed.substr(0, filmed.size() / 5) != filmed.substr(filmed.size() - filmed.size() / 5));
    const ReplayReport again = replay({.file = ffmpeg.file("run.rec"), .video = ffmpeg.file("again.mp4"), .fps = 50});
    CHECK(again.pictures == std::vector<std::string>{ffmpeg.file("again.mp4")});
    CHECK(ffmpeg.read("input") == filmed);
}

TEST_CASE("an AVI needs no program: its head counts the pictures, and each of them is a JPEG that its index finds")
{
    const FakeFfmpeg none("", "");
    const std::string name = none.file("out.avi");
    VideoFile video(name, 16, 8, 10);
    video.show(picture(16, 8, 200), 0.1);
    video.show(picture(16, 8, 100), 0.35);
    video.close();
    const std::string bytes = none.read("out.avi");
    const auto number = [&](std::size_t at) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value |= std::size_t(static_cast<unsigned char>(bytes.at(at + i))) << 8 * i;
        return value;
    };
    CHECK(bytes.substr(0, 4) == "RIFF");
    CHECK(number(4) == bytes.size() - 8);
    const std::size_t head = bytes.find("avih") + 8;
    CHECK(number(head) == 100'000); // [us] for each picture
    CHECK(number(head + 16) == 3);  // pictures
    CHECK(number(head + 32) == 16);
    CHECK(number(head + 36) == 8);
    const std::size_t list = bytes.find("movi"), index = bytes.find("idx1");
    REQUIRE(number(index + 4) == 3 * 16);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t entry = index + 8 + 16 * i, at = list + number(entry + 8);
        CHECK(bytes.substr(entry, 4) == "00dc");
        CHECK(bytes.substr(at, 4) == "00dc");
        CHECK(number(at + 4) == number(entry + 12));
        const std::string jpeg = bytes.substr(at + 8, number(at + 4));
        CHECK(jpeg.substr(0, 3) == "\xff\xd8\xff");
        CHECK(jpeg.substr(jpeg.size() - 2) == "\xff\xd9");
        std::ofstream(none.folder / "one.jpg", std::ios::binary) << jpeg;
        const visual::Image read = visual::loadImage(none.folder / "one.jpg");
        CHECK(read.width == 16);
        CHECK(std::abs(int(read.pixel(3, 3)[0]) - (i == 0 ? 200 : 100)) < 4);
    }
    const std::string never = none.file("never.avi");
    CHECK_THROWS_WITH(AviFile(never, 0, 2, 1), Catch::Contains("must be in [1, 8192] px, got 0 x 2"));
    CHECK_THROWS_WITH(AviFile(never, 2, 2, 0), Catch::Contains("fps must be in [0.001, 1000] 1/s, got 0"));
    CHECK_FALSE(std::filesystem::exists(never));
    CHECK_THROWS_WITH(VideoFile("/nowhere/out.avi", 2, 2, 1), Catch::Contains("/nowhere/out.avi"));
}

} // namespace video_test
