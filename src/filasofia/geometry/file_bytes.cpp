#include "filasofia/geometry/file_bytes.h"

#include "filasofia/core/error.h"

#include <cstdint>
#include <fstream>

namespace filasofia::geometry {

/// A mesh of 300,000 tetrahedra is 13 MB of text: a file larger than this is not a mesh.
constexpr std::uintmax_t kMaxFileSize = 4'000'000'000;

std::string readFile(const std::filesystem::path& file)
{
    std::error_code problem;
    const std::filesystem::file_status status = std::filesystem::status(file, problem);
    if (!std::filesystem::exists(status)) fail(file.string(), ": no such file");
    if (std::filesystem::is_directory(status)) fail(file.string(), ": must be a file, got a directory");
    if (!std::filesystem::is_regular_file(status)) fail(file.string(), ": is not a regular file");
    const auto size = std::filesystem::file_size(file, problem);
    if (problem) fail(file.string(), ": cannot be read: ", problem.message());
    if (size == 0) fail(file.string(), ": is empty");
    if (size > kMaxFileSize) fail(file.string(), ": must have at most ", kMaxFileSize, " bytes, got ", size);
    std::ifstream in(file, std::ios::binary);
    std::string bytes(size, '\0');
    if (!in.read(bytes.data(), static_cast<std::streamsize>(size))) fail(file.string(), ": cannot be read");
    return bytes;
}

} // namespace filasofia::geometry
