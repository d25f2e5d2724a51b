// A build without Filament (-DFILASOFIA_FILAMENT=OFF): only the null backend.
#include "filasofia/core/error.h"
#include "filasofia/visual/gpu.h"
#include "filasofia/visual/null_backend.h"

namespace filasofia::visual {

bool hasBackend(Backend backend) { return backend == Backend::Null; }

std::unique_ptr<RenderBackend> makeBackend(const VisualServerDef& def)
{
    if (!hasBackend(def.backend))
        fail("visual server: backend: this build draws nothing (FILASOFIA_FILAMENT=OFF), only Backend::Null is "
             "available");
    return std::make_unique<NullBackend>(def.width, def.height);
}

GpuReport probeGpu() noexcept
{
    GpuReport report;
    try {
        report.problem = "this build draws nothing (FILASOFIA_FILAMENT=OFF)";
    } catch (...) { // not enough memory for the text: the report is still true
    }
    return report;
}

} // namespace filasofia::visual
