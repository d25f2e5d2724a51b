#include "filasofia/core/user_file.h"

#include "filasofia/core/error.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace filasofia {
namespace {

constexpr std::size_t kRead = 1 << 16; ///< [bytes] at a time

std::string messageOf(int problem) { return std::generic_category().message(problem); }

[[noreturn]] void refuseSize(std::string_view object, std::uintmax_t maxBytes, std::string_view got)
{
    fail(object, ": must have at most ", maxBytes, " bytes, got ", got);
}

/// Waits until the pipe has bytes or has ended. The writer may not have opened its end yet.
void waitForPipe(int file, double seconds, const std::string& object)
{
    pollfd wanted{.fd = file, .events = POLLIN, .revents = 0};
    const int answer = ::poll(&wanted, 1, static_cast<int>(1e3 * seconds));
    if (answer == 0) fail(object, ": is a pipe into which nothing was written for ", seconds, " s");
}

} // namespace

void checkFileName(const std::filesystem::path& file, std::string_view object)
{
    if (file.native().find('\0') != std::string::npos)
        fail(oneLine(std::string(object)), ": a file name must not have a byte of value 0");
}

std::uintmax_t checkRegularFile(const std::filesystem::path& file, std::string_view object, std::uintmax_t maxBytes)
{
    checkFileName(file, object);
    std::error_code problem;
    const std::filesystem::file_status status = std::filesystem::status(file, problem);
    if (status.type() == std::filesystem::file_type::not_found) fail(object.empty() ? "''" : object, ": no such file");
    if (!std::filesystem::exists(status)) fail(object, ": cannot be read: ", problem.message());
    if (std::filesystem::is_directory(status)) fail(object, ": must be a file, got a directory");
    if (!std::filesystem::is_regular_file(status)) fail(object, ": is not a regular file");
    const std::uintmax_t size = std::filesystem::file_size(file, problem);
    if (problem) fail(object, ": cannot be read: ", problem.message());
    if (size > maxBytes) refuseSize(object, maxBytes, text(size));
    return size;
}

std::string readFile(const std::filesystem::path& file, std::string_view object, std::uintmax_t maxBytes)
{
    const std::uintmax_t size = checkRegularFile(file, object, maxBytes);
    std::ifstream in(file, std::ios::binary);
    if (!in) fail(object, ": cannot be read: ", messageOf(errno));
    std::string bytes(size, '\0');
    if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) fail(object, ": cannot be read to its end");
    return bytes;
}

LineReader::LineReader(const std::filesystem::path& file, std::string object, const Limits& limits)
    : object_(std::move(object)), limits_(limits)
{
    // Without O_NONBLOCK, opening a pipe would wait for its writer forever.
    file_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) fail(object_, errno == ENOENT ? ": no such file" : ": cannot be read: " + messageOf(errno));
    struct stat status = {};
    const bool known = ::fstat(file_, &status) == 0;
    pipe_ = known && S_ISFIFO(status.st_mode);
    if (known && (S_ISREG(status.st_mode) || pipe_)) return;
    ::close(file_);
    if (known && S_ISDIR(status.st_mode)) fail(object_, ": must be a file, got a directory");
    fail(object_, ": must be a regular file or a pipe");
}

LineReader::~LineReader() { ::close(file_); }

bool LineReader::fill()
{
    buffer_.erase(0, at_);
    at_ = 0;
    const std::size_t before = buffer_.size();
    buffer_.resize(before + kRead);
    ssize_t count = -1;
    do {
        if (pipe_) waitForPipe(file_, limits_.wait, object_);
        count = ::read(file_, buffer_.data() + before, kRead);
    } while (count < 0 && (errno == EINTR || (pipe_ && errno == EAGAIN)));
    if (count < 0) fail(object_, ": cannot be read to its end: ", messageOf(errno));
    buffer_.resize(before + static_cast<std::size_t>(count));
    taken_ += static_cast<std::uintmax_t>(count);
    if (taken_ > limits_.bytes) refuseSize(object_, limits_.bytes, "more");
    return count > 0;
}

std::optional<std::string_view> LineReader::next()
{
    ++line_;
    std::size_t end = std::string::npos;
    for (std::size_t searched = at_; (end = buffer_.find('\n', searched)) == std::string::npos;) {
        if (buffer_.size() - at_ > limits_.line) break;
        searched = buffer_.size() - at_; // fill() moves the remaining bytes to the front
        if (fill()) continue;
        if (buffer_.empty()) return std::nullopt;
        end = buffer_.size(); // the last line may lack its end
        break;
    }
    if (end == std::string::npos || end - at_ > limits_.line)
        fail(place(), ": must have at most ", limits_.line, " bytes, got more");
    std::string_view line(buffer_.data() + at_, end - at_);
    at_ = std::min(end + 1, buffer_.size());
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string LineReader::place() const { return text(object_, ": line ", line_); }

} // namespace filasofia
