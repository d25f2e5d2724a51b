#pragma once

#include "filasofia/runtime/avi_file.h"
#include "filasofia/runtime/child_process.h"
#include "filasofia/visual/image.h"

#include <optional>

namespace filasofia::runtime {

/// A file of pictures: an MP4, which the program ffmpeg encodes from raw pictures, or an AVI, which needs no program.
class VideoFile {
public:
    /// Throws an Error before the run if the file is an MP4, and ffmpeg is not on PATH or does not even print its
    /// version.
    VideoFile(const std::string& file, int width, int height, double fps);

    /// Writes the picture as often as is due until `time` [s] of the video, perhaps not at all. If the picture has
    /// another size than the video, it is cropped or padded with black. Throws an Error if ffmpeg takes no more, or if
    /// the file cannot be written.
    void show(const visual::Image& image, double time);
    /// Whether show() at this time would write a picture.
    [[nodiscard]] bool due(double time) const;
    /// Throws an Error with ffmpeg's reason if it does not finish the file.
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
    std::optional<AviFile> avi_; ///< in place of ffmpeg
};

/// Throws an Error naming object, field and bound if a name is neither empty nor that of a video that can be written:
/// .mp4 or .avi.
void checkVideoFile(const char* object, const std::string& file);

} // namespace filasofia::runtime
