#pragma once

#include <filesystem>
#include <string_view>

namespace filasofia {

/// Writes a file that appears at once: under the name with ".part" first, which then gets its own. If that fails, an
/// Error names the file and the reason, what was there before is still there, and no half file is left. A device or a
/// link is written to directly and stays what it is.
void writeWhole(const std::filesystem::path& path, std::string_view content);

} // namespace filasofia
