#include "filasofia/core/output_file.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/user_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace filasofia {
namespace {

constexpr const char* kNotWritten = ": cannot be written (disk full?)";

/// Opens a file that nobody else writes through this class. A file may have several names, so the file itself is
/// locked.
std::FILE* openAlone(const std::string& name)
{
    checkFileName(name, name);
    const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) fail(name, ": cannot be written");
    struct stat status = {};
    if (::fstat(file, &status) == 0 && S_ISREG(status.st_mode)) { // a device may have many writers
        // If the file system does not support locks, the file cannot be checked and is not refused.
        const bool taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
        if (taken || ::ftruncate(file, 0) != 0) { // emptied only after it is locked
            ::close(file);
            fail(name, taken ? ": is already being written, under this or another name" : ": cannot be written");
        }
    }
    std::FILE* stream = ::fdopen(file, "w");
    if (!stream) {
        ::close(file);
        fail(name, ": cannot be written");
    }
    return stream;
}

} // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : name_(path.string()), file_(openAlone(name_)) {}

OutputFile::~OutputFile()
{
    if (file_ && std::fclose(file_) != 0 && !failed_) logError(name_, kNotWritten);
}

void OutputFile::refuse()
{
    failed_ = true;
    fail(name_, kNotWritten);
}

void OutputFile::write(std::string_view text)
{
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) refuse();
}

void OutputFile::flush()
{
    if (std::fflush(file_) != 0) refuse();
}

void OutputFile::close()
{
    if (std::FILE* file = std::exchange(file_, nullptr); file && std::fclose(file) != 0) refuse();
}

} // namespace filasofia
