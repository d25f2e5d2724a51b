#pragma once

#include "filasofia/core/error.h"

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

/// The layout of a recording's file: an opening line, then chunks, each with its length and checksum, so that what was
/// written stays readable whatever happens after it. docs/design/replay.md describes the bytes.
namespace filasofia::record {

inline constexpr std::string_view kOpening = "filasofia recording, version ";
inline constexpr std::string_view kChunkMark = "FRec"; ///< the first bytes of a chunk
inline constexpr std::size_t kChunkHeader = 20;        ///< [bytes]
inline constexpr std::size_t kMaximumChunk =
    1 << 16; ///< [bytes], content: bounds what a chunk can make the reader allocate

/// Damage of the file itself; the message names the file and the byte.
struct FileDamage : Error {
    using Error::Error;
};

/// The first line of a file.
std::string openingLine();

/// The bytes of a chunk of the file: `number` is 0, 1, ..., and `content` has at most kMaximumChunk bytes.
std::string chunkOf(std::uint32_t number, std::string_view content);

/// Reads a file chunk by chunk. The file is not trusted: no number in it leads to an allocation above kMaximumChunk.
class ChunkReader {
public:
    /// Throws an Error naming the file if it is unreadable, empty, not a recording, or of another version.
    explicit ChunkReader(const std::string& name);
    /// Appends the next chunk's content; false at the end of the file. Throws FileDamage.
    bool next(std::string& content);
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::uint64_t byte() const { return byte_; } ///< position in the file where the next chunk begins

private:
    [[noreturn]] void damaged(std::string_view why) const;
    [[noreturn]] void cutOff() const;
    bool read(std::string& bytes, std::size_t count);

    std::string name_;
    std::ifstream in_;
    std::uint64_t byte_ = 0;
    std::uint32_t number_ = 0; ///< number of the next chunk
};

} // namespace filasofia::record
