#include "filasofia/visual/egl_platform.h"

#include <GL/gl.h>
#include <GL/glext.h>

namespace filasofia::visual {
namespace {

struct PixelSize : filament::backend::Platform::SwapChain {
    uint32_t width = 0;
    uint32_t height = 0;
};

template <class Function> Function* gl(const char* name) { return EglContext::function<Function>(name); }

uint32_t bound(GLenum what)
{
    GLint name = 0;
    gl<void(GLenum, GLint*)>("glGetIntegerv")(what, &name);
    return static_cast<uint32_t>(name);
}

} // namespace

filament::backend::Driver* EglPlatform::createDriver(void* sharedContext) noexcept
{
    std::string problem; // the backend has probed before, so a failure was reported there
    if (!context_.create(sharedContext, problem)) return nullptr;
    return createDefaultDriver(this, sharedContext);
}

filament::backend::Platform::SwapChain* EglPlatform::createSwapChain(uint32_t width, uint32_t height,
                                                                     uint64_t&) noexcept
{
    auto* size = new PixelSize;
    size->width = width;
    size->height = height;
    return size;
}

void EglPlatform::destroySwapChain(SwapChain* swapChain) noexcept { delete static_cast<PixelSize*>(swapChain); }

void EglPlatform::setStorage(uint32_t width, uint32_t height)
{
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    const auto bind = gl<void(GLenum, GLuint)>("glBindRenderbuffer");
    const auto store = gl<void(GLenum, GLenum, GLsizei, GLsizei)>("glRenderbufferStorage");
    const uint32_t before = bound(GL_RENDERBUFFER_BINDING); // Filament caches the bound buffer, so it is restored
    bind(GL_RENDERBUFFER, buffers_[0]);
    store(GL_RENDERBUFFER, GL_RGBA8, GLsizei(width), GLsizei(height));
    bind(GL_RENDERBUFFER, buffers_[1]);
    store(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, GLsizei(width), GLsizei(height));
    bind(GL_RENDERBUFFER, before);
}

void EglPlatform::createDefaultRenderTarget(uint32_t& framebuffer, uint32_t& color, uint32_t& depth) noexcept
{
    // Called once per Renderer, which deletes its framebuffer at its end: so a new framebuffer each time, on shared
    // buffers.
    if (buffers_[0] == 0) {
        gl<void(GLsizei, GLuint*)>("glGenRenderbuffers")(2, buffers_);
        setStorage(1, 1);
    }
    gl<void(GLsizei, GLuint*)>("glGenFramebuffers")(1, &framebuffer);
    const auto bind = gl<void(GLenum, GLuint)>("glBindFramebuffer");
    const auto attachTo = gl<void(GLenum, GLenum, GLenum, GLuint)>("glFramebufferRenderbuffer");
    const uint32_t before = bound(GL_DRAW_FRAMEBUFFER_BINDING);
    bind(GL_FRAMEBUFFER, framebuffer);
    attachTo(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[0]);
    attachTo(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, buffers_[1]);
    bind(GL_FRAMEBUFFER, before);
    color = buffers_[0];
    depth = buffers_[1];
}

void EglPlatform::makeCurrent(SwapChain* draw, SwapChain*) noexcept
{
    const auto* size = static_cast<const PixelSize*>(draw);
    setStorage(size->width, size->height);
}

void EglPlatform::commit(SwapChain*) noexcept { gl<void()>("glFlush")(); }

} // namespace filasofia::visual
