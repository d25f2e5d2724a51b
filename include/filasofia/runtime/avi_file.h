#pragma once

#include "filasofia/core/output_file.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// A video of JPEG pictures in an AVI file (Motion JPEG), written without any other program. Most players show it,
/// browsers do not.
class AviFile {
public:
    /// `width` and `height`: [px], in [1, 8192]; `fps`: [1/s], in [0.001, 1000]. Throws an Error if one is out of
    /// range, or naming the file if it cannot be written, as the other functions do.
    AviFile(const std::string& file, int width, int height, double fps);

    /// Adds a picture of the video's size, four bytes per pixel. Error if the file would be larger than 2 GB, which is
    /// what players read.
    void add(std::span<const unsigned char> rgba);
    /// Writes the index and the length.
    void close();

private:
    [[nodiscard]] std::string head() const;

    int width_;
    int height_;
    double fps_;
    OutputFile out_;
    std::uint32_t written_ = 0;                       ///< [bytes], all pictures with what stands before each
    std::uint32_t largest_ = 0;                       ///< [bytes], the largest picture
    std::vector<std::array<std::uint32_t, 2>> index_; ///< place in the list and size of each picture
};

} // namespace filasofia::runtime
