#include "filasofia/runtime/assets.h"

#include "filasofia/core/error.h"

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace filasofia::runtime {

std::string asset(const std::string& name, const std::string& installed)
{
    namespace fs = std::filesystem;
    std::vector<fs::path> folders;
    if (const char* given = std::getenv("FILASOFIA_ASSETS")) folders.emplace_back(given);
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    folders.push_back(program.parent_path().parent_path() / "share/filasofia");
    if (!installed.empty()) folders.emplace_back(installed);
    folders.emplace_back(FILASOFIA_SOURCE_ASSETS);
    folders.emplace_back(FILASOFIA_INSTALLED_ASSETS);

    std::string tried;
    for (const fs::path& folder : folders) {
        if (fs::is_regular_file(folder / name, ignored)) return (folder / name).string();
        tried += (tried.empty() ? "" : ", ") + folder.string();
    }
    fail("asset '", name, "' is in none of ", tried, " (FILASOFIA_ASSETS may name another folder)");
}

} // namespace filasofia::runtime
