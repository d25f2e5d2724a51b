#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace filasofia::scene {

/// The path from `folder` to a file in it; empty if the file is elsewhere, also behind links.
inline std::string pathWithin(const std::filesystem::path& folder, const std::filesystem::path& file)
{
    std::error_code problem;
    const auto relative = std::filesystem::weakly_canonical(file, problem)
                              .lexically_relative(std::filesystem::weakly_canonical(folder, problem));
    if (problem || relative.empty() || *relative.begin() == "..") return {};
    return relative.generic_string();
}

} // namespace filasofia::scene
