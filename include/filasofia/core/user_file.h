#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

/// Reads files that a user names. Whatever is behind the name, reading ends and takes no more memory than the limits.
namespace filasofia {

constexpr std::uintmax_t kMaxFile = 4'000'000'000; ///< [bytes]; a mesh of 300,000 tetrahedra is 13 MB of text

/// Throws an Error "<object>: ..." if the name has a byte of value 0, at which the system would end it.
void checkFileName(const std::filesystem::path& file, std::string_view object);

/// Throws an Error "<object>: ..." unless `file` is a regular file of at most `maxBytes`: a device never ends, and
/// opening a pipe waits for its writer. Links are followed. Returns its size [bytes].
std::uintmax_t checkRegularFile(const std::filesystem::path& file, std::string_view object,
                                std::uintmax_t maxBytes = kMaxFile);

/// Returns the whole of a regular file. Throws an Error "<object>: ..." also if it cannot be read to its end.
std::string readFile(const std::filesystem::path& file, std::string_view object, std::uintmax_t maxBytes = kMaxFile);

/// Reads the lines of a regular file or a pipe, one at a time, without their ends ("\n" or "\r\n").
class LineReader {
public:
    struct Limits {
        std::uintmax_t bytes = 1'000'000'000; ///< of the whole file
        std::size_t line = 4096;              ///< [bytes] of one line
        double wait = 10.0;                   ///< [s], for a pipe that sends nothing
    };

    /// Throws an Error "<object>: ..." if there is no such file, or if it is neither a regular file nor a pipe.
    LineReader(const std::filesystem::path& file, std::string object, const Limits& limits);
    LineReader(const std::filesystem::path& file, std::string object) : LineReader(file, std::move(object), Limits{}) {}
    ~LineReader();
    LineReader(const LineReader&) = delete;
    LineReader& operator=(const LineReader&) = delete;

    /// The line is valid until the next call; nothing is returned at the end of the file. Throws an Error naming the
    /// line that is too long, or the object if the file is too large or cannot be read to its end.
    std::optional<std::string_view> next();
    /// "<object>: line <number>", for the line that next() returned last.
    [[nodiscard]] std::string place() const;

private:
    bool fill(); ///< returns false if the file has ended

    std::string object_;
    Limits limits_;
    int file_ = -1;
    bool pipe_ = false;
    std::uintmax_t taken_ = 0; ///< [bytes] read from the file
    std::uint64_t line_ = 0;   ///< number of the last line, from 1
    std::string buffer_;       ///< one line and the bytes read after it
    std::size_t at_ = 0;       ///< start of the next line in the buffer
};

} // namespace filasofia
