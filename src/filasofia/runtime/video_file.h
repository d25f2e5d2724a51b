#pragma once

#include "filasofia/runtime/child_process.h"
#include "filasofia/visual/image.h"

#include <optional>

namespace filasofia::runtime {

/// An MP4 file of pictures, made by the program ffmpeg, which gets them raw.
class VideoFile {
public:
    /// Throws an Error where ffmpeg is not on PATH or does not even tell its version: before the run, not after it.
    VideoFile(const std::string& file, int width, int height, double fps);

    /// Shows the picture until `time` [s] of the video: as often as is due by then, perhaps not at all. A picture of
    /// another size than the video's is cut off, or has black beside it. Throws an Error where ffmpeg takes no more.
    void show(const visual::Image& image, double time);
    /// Whether show() at this time would write a picture.
    [[nodiscard]] bool due(double time) const;
    /// Throws an Error with ffmpeg's reason where it does not finish the file.
    void close();

private:
    [[noreturn]] void failed(const std::string& why) const;

    std::string file_;
    int width_;
    int height_;
    double fps_;
    long written_ = 0;
    std::vector<unsigned char> picture_;
    std::optional<ChildProcess> ffmpeg_;
};

} // namespace filasofia::runtime
