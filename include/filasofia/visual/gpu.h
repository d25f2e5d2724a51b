#pragma once

#include <string>

namespace filasofia::visual {

/// What draws on this machine without a window.
struct GpuReport {
    bool available = false; ///< an OpenGL 4.1 core context could be made without a window
    bool software = false;  ///< the renderer runs on the processor (llvmpipe, softpipe, swrast)
    std::string vendor;     ///< GL_VENDOR
    std::string renderer;   ///< GL_RENDERER
    std::string version;    ///< GL_VERSION
    std::string problem;    ///< if it is not available: why, in one line
};

/// Makes a headless context for a moment and queries it. Never throws.
GpuReport probeGpu() noexcept;

} // namespace filasofia::visual
