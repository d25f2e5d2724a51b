#include "filasofia/core/whole_file.h"

#include "filasofia/core/error.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace filasofia {
namespace {

/// What went wrong, or nothing. A full disk may show only when the file is closed.
std::error_code writeTo(const std::filesystem::path& path, std::string_view content, bool& opened)
{
    errno = 0;
    const auto problem = [] { return std::error_code(errno != 0 ? errno : EIO, std::generic_category()); };
    std::FILE* file = std::fopen(path.c_str(), "wbe");
    opened = file != nullptr;
    if (!file) return problem();
    std::error_code found;
    if (std::fwrite(content.data(), 1, content.size(), file) != content.size()) found = problem();
    if (std::fclose(file) != 0 && !found) found = problem();
    return found;
}

} // namespace

void writeWhole(const std::filesystem::path& path, std::string_view content)
{
    std::error_code none;
    const std::filesystem::file_status there = std::filesystem::symlink_status(path, none);
    const bool direct = std::filesystem::exists(there) && !std::filesystem::is_regular_file(there);
    std::filesystem::path part = path;
    if (!direct) part += ".part";
    bool opened = false;
    std::error_code problem = writeTo(part, content, opened);
    if (!problem && !direct) std::filesystem::rename(part, path, problem);
    if (!problem) return;
    if (opened && !direct) std::filesystem::remove(part, none);
    fail(path.string(), ": cannot be written (", problem.message(), ")");
}

} // namespace filasofia
