#pragma once

#include "filasofia/visual/egl_context.h"

#include <backend/DriverEnums.h>
#include <backend/Platform.h>

// libfilament_backend.so of Filament 1.9.25 exports this class, but Debian does not install its header. So it is
// declared here: the order of the virtual functions is the library's ABI and was read from its vtable. CMakeLists.txt
// refuses any other version.
namespace filament::backend {

struct AcquiredImage;

class OpenGLPlatform : public DefaultPlatform {
public:
    ~OpenGLPlatform() noexcept override;
    virtual void terminate() noexcept = 0;
    virtual SwapChain* createSwapChain(void* nativeWindow, uint64_t& flags) noexcept = 0;
    virtual SwapChain* createSwapChain(uint32_t width, uint32_t height, uint64_t& flags) noexcept = 0;
    virtual void destroySwapChain(SwapChain* swapChain) noexcept = 0;
    virtual void createDefaultRenderTarget(uint32_t& framebuffer, uint32_t& color, uint32_t& depth) noexcept;
    virtual void makeCurrent(SwapChain* draw, SwapChain* read) noexcept = 0;
    virtual void commit(SwapChain* swapChain) noexcept = 0;
    virtual void setPresentationTime(int64_t nanoseconds) noexcept = 0;
    virtual bool canCreateFence() noexcept;
    virtual Fence* createFence() noexcept = 0;
    virtual void destroyFence(Fence* fence) noexcept = 0;
    virtual FenceStatus waitFence(Fence* fence, uint64_t timeout) noexcept = 0;
    virtual Stream* createStream(void* nativeStream) noexcept = 0;
    virtual void destroyStream(Stream* stream) noexcept = 0;
    virtual void attach(Stream* stream, intptr_t texture) noexcept = 0;
    virtual void detach(Stream* stream) noexcept = 0;
    virtual void updateTexImage(Stream* stream, int64_t* timestamp) noexcept = 0;
    virtual ExternalTexture* createExternalTextureStorage() noexcept = 0;
    virtual void reallocateExternalStorage(ExternalTexture* texture, uint32_t width, uint32_t height,
                                           TextureFormat format) noexcept = 0;
    virtual void destroyExternalTextureStorage(ExternalTexture* texture) noexcept = 0;
    virtual AcquiredImage transformAcquiredImage(AcquiredImage source) noexcept;
    virtual bool setExternalImage(void* externalImage, void* texture) noexcept;
    virtual void retainExternalImage(void* externalImage) noexcept;
    virtual void releaseExternalImage(void* externalImage) noexcept;
    virtual void createExternalImageTexture(void* texture) noexcept;
    virtual void destroyExternalImage(void* texture) noexcept;

protected:
    static Driver* createDefaultDriver(OpenGLPlatform* platform, void* sharedContext);
};

} // namespace filament::backend

namespace filasofia::visual {

/// Filament without a screen: a surfaceless EGL context, and our own framebuffer in place of a window. (EGL pbuffers
/// would be simpler, but Mesa loses what a core context clears there.) Filament calls it from its own thread.
class EglPlatform final : public filament::backend::OpenGLPlatform {
public:
    int getOSVersion() const noexcept override { return 0; }
    filament::backend::Driver* createDriver(void* sharedContext) noexcept override;
    void terminate() noexcept override { context_.destroy(); }

    SwapChain* createSwapChain(void*, uint64_t&) noexcept override { return nullptr; }
    SwapChain* createSwapChain(uint32_t width, uint32_t height, uint64_t&) noexcept override;
    void destroySwapChain(SwapChain* swapChain) noexcept override;
    void createDefaultRenderTarget(uint32_t& framebuffer, uint32_t& color, uint32_t& depth) noexcept override;
    void makeCurrent(SwapChain* draw, SwapChain* read) noexcept override;
    void commit(SwapChain*) noexcept override;
    void setPresentationTime(int64_t) noexcept override {}

    Fence* createFence() noexcept override { return new Fence(); }
    void destroyFence(Fence* fence) noexcept override { delete fence; }
    filament::backend::FenceStatus waitFence(Fence*, uint64_t) noexcept override
    {
        return filament::backend::FenceStatus::CONDITION_SATISFIED;
    }

    // Video streams are not supported.
    Stream* createStream(void*) noexcept override { return nullptr; }
    void destroyStream(Stream*) noexcept override {}
    void attach(Stream*, intptr_t) noexcept override {}
    void detach(Stream*) noexcept override {}
    void updateTexImage(Stream*, int64_t*) noexcept override {}
    ExternalTexture* createExternalTextureStorage() noexcept override { return nullptr; }
    void reallocateExternalStorage(ExternalTexture*, uint32_t, uint32_t,
                                   filament::backend::TextureFormat) noexcept override
    {
    }
    void destroyExternalTextureStorage(ExternalTexture*) noexcept override {}

private:
    void setStorage(uint32_t width, uint32_t height);

    EglContext context_;
    uint32_t buffers_[2] = {0, 0}; ///< renderbuffers: colour, depth and stencil
    uint32_t width_ = 0;
    uint32_t height_ = 0;
};

} // namespace filasofia::visual
