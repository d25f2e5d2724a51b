#include "filasofia/runtime/assets.h"

#include "filasofia/core/error.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <vector>

namespace filasofia::runtime {
namespace {

namespace fs = std::filesystem;

/// The folder `data` beside the shared library that this code is part of, as in the Python package, which may be
/// anywhere; empty if it is part of the program itself.
fs::path besideLibrary(const fs::path& program)
{
    Dl_info found = {};
    if (dladdr(reinterpret_cast<const void*>(&besideLibrary), &found) == 0 || !found.dli_fname) return {};
    if (!fs::path(found.dli_fname).is_absolute()) return {}; // a program that the shell found
    std::error_code ignored;
    const fs::path library = fs::canonical(found.dli_fname, ignored);
    return library.empty() || library == program ? fs::path() : library.parent_path() / "data";
}

std::vector<fs::path> assetFolders(const std::string& installed)
{
    std::vector<fs::path> folders;
    if (const char* given = std::getenv("FILASOFIA_ASSETS")) folders.emplace_back(given);
    std::error_code ignored;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    folders.push_back(program.parent_path().parent_path() / "share/filasofia");
    if (!installed.empty()) folders.emplace_back(installed);
    if (const fs::path beside = besideLibrary(program); !beside.empty() && beside != installed)
        folders.push_back(beside);
    folders.emplace_back(FILASOFIA_SOURCE_ASSETS);
    folders.emplace_back(FILASOFIA_INSTALLED_ASSETS);
    return folders;
}

} // namespace

std::string asset(const std::string& name, const std::string& installed)
{
    std::string tried;
    std::error_code ignored;
    for (const fs::path& folder : assetFolders(installed)) {
        if (fs::is_regular_file(folder / name, ignored)) return (folder / name).string();
        tried += (tried.empty() ? "" : ", ") + folder.string();
    }
    fail("asset '", name, "' is in none of ", tried, " (FILASOFIA_ASSETS may name another folder)");
}

std::vector<std::string> assetsIn(const std::string& folder, const std::string& type, const std::string& installed)
{
    std::map<std::string, std::string> found; // by name
    std::error_code ignored;
    for (const fs::path& place : assetFolders(installed))
        for (const auto& entry : fs::directory_iterator(place / folder, ignored))
            if (entry.path().extension() == type && entry.is_regular_file(ignored))
                found.try_emplace(entry.path().filename().string(), entry.path().string());
    std::vector<std::string> files;
    for (const auto& [name, file] : found) files.push_back(file);
    return files;
}

} // namespace filasofia::runtime
