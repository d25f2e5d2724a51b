#include "filasofia/scene/import.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/user_file.h"
#include "filasofia/scene/scene_file.h"

#include <algorithm>
#include <cctype>

namespace filasofia::scene {
namespace {

std::string extensionOf(const std::filesystem::path& file)
{
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

/// Whether an XML file's first element is this one.
bool beginsWith(const std::filesystem::path& file, std::string_view element)
{
    const std::string bytes = readFile(file, file.string());
    for (std::size_t at = bytes.find('<'); at != std::string::npos; at = bytes.find('<', at + 1)) {
        const std::string_view rest = std::string_view(bytes).substr(at);
        if (rest.starts_with("<!--"))
            at = bytes.find("-->", at);
        else if (rest.size() > 1 && rest[1] != '?' && rest[1] != '!')
            return rest.starts_with(element);
        if (at == std::string::npos) break;
    }
    return false;
}

} // namespace

bool isSceneFile(const std::filesystem::path& file)
{
    const std::string extension = extensionOf(file);
    return extension == ".json" || extension == ".urdf" || extension == ".xml" || extension == ".mjcf" ||
           extension == ".scn";
}

SceneDef loadAnyScene(const std::filesystem::path& file, const ImportOptions& options)
{
    const std::string extension = extensionOf(file);
    if (extension != ".urdf" && extension != ".xml" && extension != ".mjcf" && extension != ".scn") {
        if (options.strict)
            fail(file.string(), ": strict is for URDF, MJCF and .scn: all that a scene file says is read");
        if (!options.packages.empty())
            fail(file.string(), ": a package is for URDF and .scn, and this is a scene file");
        if (options.unit != 1.0) fail(file.string(), ": a unit is for scenes of SOFA (.scn), and this is a scene file");
        return loadScene(file, {.anyFolder = options.anyFolder});
    }
    const auto is = [&](const char* own, std::string_view element) {
        return extension == own || (extension == ".xml" && beginsWith(file, element));
    };
    const bool robot = is(".urdf", "<robot"), sofa = !robot && is(".scn", "<Node");
    if (options.unit != 1.0 && !sofa)
        fail(file.string(), ": a unit is for scenes of SOFA (.scn): URDF and MJCF are in metres");
    Imported imported = robot ? loadUrdf(file, options) : sofa ? loadScn(file, options) : loadMjcf(file, options);
    for (const std::string& note : imported.notes) logWarning(note);
    return std::move(imported.scene);
}

} // namespace filasofia::scene
