#pragma once

#include <string>

namespace filasofia::visual {

/// What draws on this machine when there is no window.
struct GpuReport {
    bool available = false; ///< an OpenGL 4.1 core context without a window could be made
    bool software = false;  ///< the renderer is the processor (llvmpipe, softpipe, swrast)
    std::string vendor;     ///< GL_VENDOR
    std::string renderer;   ///< GL_RENDERER
    std::string version;    ///< GL_VERSION
    std::string problem;    ///< why not, in one line, where it is not available
};

/// Makes a headless context for a moment and asks it. Never throws.
GpuReport probeGpu() noexcept;

} // namespace filasofia::visual
