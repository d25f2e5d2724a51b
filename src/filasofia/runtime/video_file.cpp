#include "filasofia/runtime/video_file.h"

#include "filasofia/core/error.h"
#include "filasofia/runtime/check_file.h"

#include <algorithm>
#include <filesystem>

namespace filasofia::runtime {
namespace {

constexpr double kFinishTimeout = 120.0;  ///< [s] to encode the last pictures
constexpr double kPictureRounding = 1e-6; ///< [pictures]; 250 steps of 5 ms sum to a little less than 1.25 s

/// ffmpeg's file, after a test that it runs.
std::string workingFfmpeg()
{
    const std::string program = programOnPath("ffmpeg");
    if (program.empty()) fail("run: video needs the program ffmpeg, which is in no folder of PATH");
    ChildProcess asked(program, {"-hide_banner", "-loglevel", "error", "-version"});
    if (const std::string why = asked.finish(20.0); !why.empty())
        fail("run: video needs the program ffmpeg, but ", program, " does not run: ", why);
    return program;
}

/// H.264 halves the resolution of colours and needs even sizes: a picture of odd size gets a black line.
std::vector<std::string> arguments(const std::string& file, int width, int height, double fps)
{
    return {"-hide_banner",
            "-loglevel",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgba",
            "-video_size",
            text(width, "x", height),
            "-framerate",
            text(fps),
            "-i",
            "pipe:0",
            "-an",
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-pix_fmt",
            "yuv420p",
            "-movflags",
            "+faststart",
            "file:" + file};
}

} // namespace

VideoFile::VideoFile(const std::string& file, int width, int height, double fps)
    : file_(file), width_(width), height_(height), fps_(fps)
{
    if (std::filesystem::path(file).extension() == ".avi")
        avi_.emplace(file, width, height, fps);
    else
        ffmpeg_.emplace(workingFfmpeg(), arguments(file, width, height, fps));
}

bool VideoFile::due(double time) const { return static_cast<double>(written_ + 1) <= time * fps_ + kPictureRounding; }

void VideoFile::show(const visual::Image& image, double time)
{
    if (!due(time)) return;
    const std::vector<unsigned char>* pixels = &image.rgba;
    if (image.width != width_ || image.height != height_) {
        picture_.assign(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
        const auto row = [](auto& all, int width, int y) { return all.begin() + 4 * static_cast<long>(width) * y; };
        for (int y = 0; y < std::min(height_, image.height); ++y)
            std::copy_n(row(image.rgba, image.width, y), 4 * std::min(width_, image.width), row(picture_, width_, y));
        pixels = &picture_;
    }
    for (; due(time); ++written_) {
        if (avi_)
            avi_->add(*pixels);
        else if (!ffmpeg_->feed(*pixels))
            failed(ffmpeg_->finish(1.0));
    }
}

void VideoFile::close()
{
    if (avi_) return avi_->close();
    if (const std::string why = ffmpeg_->finish(kFinishTimeout); !why.empty()) failed(why);
    ffmpeg_.reset();
}

void VideoFile::failed(const std::string& why) const
{
    fail("video '", file_, "': ffmpeg took ", written_, written_ == 1 ? " picture" : " pictures", " and no more",
         why.empty() ? "" : ": ", why);
}

void checkVideoFile(const char* object, const std::string& file)
{
    const std::string extension = std::filesystem::path(file).extension().string();
    if (!file.empty() && extension != ".mp4" && extension != ".avi")
        fail(object, ": video must end in .mp4 or .avi, got '", file, "'");
    checkFile(object, file, "video", extension.c_str());
}

} // namespace filasofia::runtime
