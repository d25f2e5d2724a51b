#include "apps/filasofia/commands.h"
#include "filasofia/scene/scene_file.h"

#include <iostream>

namespace filasofia::app {

Command schemaCommand()
{
    return {.name = "schema",
            .meaning = "Print the JSON Schema of scene files, by which editors complete and check them",
            .run = [] {
                std::cout << scene::sceneSchema() << '\n';
                return 0;
            }};
}

} // namespace filasofia::app
