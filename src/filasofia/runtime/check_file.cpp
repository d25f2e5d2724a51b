#include "filasofia/runtime/check_file.h"

#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"

#include <filesystem>

namespace filasofia::runtime {

void checkFile(const char* object, const std::string& file, const char* field, const char* extension)
{
    if (file.empty()) return;
    checkFileName(file, text(object, ": ", field, " '", file, "'"));
    const std::filesystem::path path(file);
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    if (path.extension() != extension) fail(object, ": ", field, " must end in ", extension, ", got '", file, "'");
    std::error_code problem; // a name too long, a folder that may not be entered, a link in a circle
    if (!std::filesystem::is_directory(folder, problem))
        fail(object, ": ", field, " '", file, "': there is no such folder");
    const auto status = std::filesystem::status(path, problem);
    if (std::filesystem::is_directory(status)) fail(object, ": ", field, " '", file, "' is a folder");
    if (!std::filesystem::status_known(status)) fail(object, ": ", field, " '", file, "': ", problem.message());
}

} // namespace filasofia::runtime
