#include "apps/filasofia/import_words.h"

namespace filasofia::app {

const char* ImportWords::given() const
{
    return anyFolder          ? "--any-folder"
           : strict           ? "--strict"
           : !package.empty() ? "--package"
           : unit != 1.0      ? "--unit"
                              : nullptr;
}

scene::ImportOptions ImportWords::options() const
{
    scene::ImportOptions out{.anyFolder = anyFolder, .strict = strict, .unit = unit};
    if (!package.empty()) out.packages = {package};
    return out;
}

void addOptions(ImportWords& words, std::vector<Option>& to)
{
    to.insert(
        to.end(),
        {{"--any-folder", &words.anyFolder, "The files that a scene file names may be outside its folder"},
         {"--strict", &words.strict, "URDF, MJCF and .scn: what is not read is an error"},
         {"--package", &words.package,
          "URDF: the folder of package://NAME, or one that has it; .scn: one that has its files", "FOLDER"},
         {"--unit", &words.unit, ".scn: its unit of length in metres, 0.001 for a scene in millimetres", "METRES"}});
}

} // namespace filasofia::app
