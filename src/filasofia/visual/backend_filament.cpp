// A build with Filament: all backends.
#include "filasofia/visual/filament_backend.h"
#include "filasofia/visual/null_backend.h"

namespace filasofia::visual {

bool hasBackend(Backend) { return true; }

std::unique_ptr<RenderBackend> makeBackend(const VisualServerDef& def)
{
    if (def.backend == Backend::Null) return std::make_unique<NullBackend>(def.width, def.height);
    return std::make_unique<FilamentBackend>(def);
}

} // namespace filasofia::visual
