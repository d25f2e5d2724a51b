#include "filasofia/runtime/avi_file.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/jpeg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace filasofia::runtime {
namespace {

constexpr std::uint32_t kMostAviBytes = 2'000'000'000;
constexpr std::uint32_t kAviHasIndex = 0x10, kAviKeyFrame = 0x10;

/// Numbers in AVI begin with their lowest byte, whatever the machine.
std::string aviNumber(std::uint32_t value, int bytes = 4)
{
    std::string out;
    for (int i = 0; i < bytes; ++i) out += static_cast<char>((value >> (8 * i)) & 0xffU);
    return out;
}

std::string aviNumbers(std::initializer_list<std::uint32_t> values)
{
    std::string out;
    for (const std::uint32_t value : values) out += aviNumber(value);
    return out;
}

std::string aviChunk(const char* name, const std::string& content)
{
    return name + aviNumber(static_cast<std::uint32_t>(content.size())) + content;
}

/// The name of a video that can be begun.
const std::string& checkedName(const std::string& file, int width, int height, double fps)
{
    if (width < 1 || width > 8192 || height < 1 || height > 8192)
        fail("video '", file, "': width and height must be in [1, 8192] px, got ", width, " x ", height);
    if (!(fps >= 1e-3 && fps <= 1e3)) fail("video '", file, "': fps must be in [0.001, 1000] 1/s, got ", fps);
    return file;
}

} // namespace

AviFile::AviFile(const std::string& file, int width, int height, double fps)
    : width_(width), height_(height), fps_(fps), out_(checkedName(file, width, height, fps))
{
    out_.write(head()); // its numbers follow at the end
}

std::string AviFile::head() const
{
    const auto width = static_cast<std::uint32_t>(width_), height = static_cast<std::uint32_t>(height_);
    const auto count = static_cast<std::uint32_t>(index_.size());
    const auto rate = static_cast<std::uint32_t>(std::lround(1000.0 * fps_)); // pictures in 1000 s
    const auto microseconds = static_cast<std::uint32_t>(std::lround(1e6 / fps_));
    const std::string main = aviChunk(
        "avih", aviNumbers({microseconds, 0, 0, kAviHasIndex, count, 0, 1, largest_, width, height, 0, 0, 0, 0}));
    const std::string stream =
        aviChunk("strh", "vidsMJPG" + aviNumbers({0, 0, 0, 1000, rate, 0, count, largest_, 0xffffffffU, 0, 0}) +
                             aviNumber(width, 2) + aviNumber(height, 2));
    const std::string format = aviChunk("strf", aviNumbers({40, width, height}) + aviNumber(1, 2) + aviNumber(24, 2) +
                                                    "MJPG" + aviNumbers({3 * width * height, 0, 0, 0, 0}));
    const std::string lists = "AVI " + aviChunk("LIST", "hdrl" + main + aviChunk("LIST", "strl" + stream + format));
    const std::uint32_t pictures = 4 + written_, index = 8 + 16 * count;
    return "RIFF" + aviNumber(static_cast<std::uint32_t>(lists.size()) + 8 + pictures + index) + lists + "LIST" +
           aviNumber(pictures) + "movi";
}

void AviFile::add(std::span<const unsigned char> rgba)
{
    std::string jpeg = visual::encodeJpeg(width_, height_, rgba);
    const auto size = static_cast<std::uint32_t>(jpeg.size());
    if (size % 2 == 1) jpeg += '\0'; // chunks begin at even places
    if (written_ + jpeg.size() + 16 * index_.size() > kMostAviBytes)
        fail("video '", out_.name(), "': it would be larger than 2 GB");
    out_.write("00dc" + aviNumber(size));
    out_.write(jpeg);
    index_.push_back({4 + written_, size});
    written_ += 8 + static_cast<std::uint32_t>(jpeg.size());
    largest_ = std::max(largest_, size);
}

void AviFile::close()
{
    std::string index;
    for (const auto& [place, size] : index_) index += "00dc" + aviNumbers({kAviKeyFrame, place, size});
    out_.write(aviChunk("idx1", index));
    out_.close();
    const std::string again = head();
    std::FILE* file = std::fopen(out_.name().c_str(), "r+b");
    const bool written = file && std::fwrite(again.data(), 1, again.size(), file) == again.size();
    if (const bool closed = !file || std::fclose(file) == 0; !written || !closed)
        fail("video '", out_.name(), "': its head cannot be written");
}

} // namespace filasofia::runtime
