#include "filasofia/visual/gpu.h"

#include "filasofia/visual/egl_context.h"

#include <GL/gl.h>

#include <thread>

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
    GpuReport report;
    try {
        // A thread of its own: the caller's may have a context that must stay current.
        std::thread([&] {
            try {
                report = ask();
            } catch (...) { // lack of memory: the report says "not available", which is true
            }
        }).join();
    } catch (...) { // no thread to be had: as above
    }
    return report;
}

} // namespace filasofia::visual
