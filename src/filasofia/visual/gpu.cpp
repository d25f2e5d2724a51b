#include "filasofia/visual/gpu.h"

#include "filasofia/visual/egl_context.h"

#include <GL/gl.h>

namespace filasofia::visual {
namespace {

GpuReport ask()
{
    GpuReport report;
    EglContext context;
    if (!context.create(nullptr, report.problem)) return report;
    const auto getString = EglContext::function<const GLubyte*(GLenum)>("glGetString");
    const auto read = [&](GLenum what) {
        const GLubyte* answer = getString ? getString(what) : nullptr;
        return std::string(answer ? reinterpret_cast<const char*>(answer) : "");
    };
    report.vendor = read(GL_VENDOR);
    report.renderer = read(GL_RENDERER);
    report.version = read(GL_VERSION);
    for (const char* processor : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"})
        report.software = report.software || report.renderer.find(processor) != std::string::npos;
    report.available = true;
    report.problem.clear();
    return report;
}

} // namespace

GpuReport probeGpu() noexcept
{
    try {
        return ask();
    } catch (...) { // out of memory: then "not available" is true
        return {};
    }
}

} // namespace filasofia::visual
