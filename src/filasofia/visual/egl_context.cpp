#include "filasofia/visual/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace filasofia::visual {
namespace {

bool hasExtension(const char* list, std::string_view name)
{
    return list && std::string_view(list).find(name) != std::string_view::npos;
}

/// Every display that needs no screen: the devices (graphics cards, then Mesa's software), then Mesa's surfaceless one.
std::vector<EGLDisplay> headlessDisplays()
{
    std::vector<EGLDisplay> displays;
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto platformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!platformDisplay) return displays;
    const auto add = [&](EGLDisplay display) {
        if (display != EGL_NO_DISPLAY) displays.push_back(display);
    };
    const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    if (hasExtension(extensions, "EGL_EXT_platform_device") && queryDevices) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (queryDevices(EGLint(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count; ++i)
                add(platformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[std::size_t(i)], nullptr));
    }
    if (hasExtension(extensions, "EGL_MESA_platform_surfaceless"))
        add(platformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return displays;
}

} // namespace

void prepareMesa() { setenv("MESA_EXTENSION_OVERRIDE", "-GL_EXT_shader_framebuffer_fetch", 0); }

EglContext::Address EglContext::address(const char* name) { return eglGetProcAddress(name); }

bool EglContext::create(void* sharedContext, std::string& problem)
{
    prepareMesa();
    beforeDisplay_ = eglGetCurrentDisplay();
    beforeContext_ = eglGetCurrentContext();
    beforeDraw_ = eglGetCurrentSurface(EGL_DRAW);
    beforeRead_ = eglGetCurrentSurface(EGL_READ);
    const std::vector<EGLDisplay> displays = headlessDisplays();
    if (displays.empty()) problem = "EGL offers no display that works without a screen";
    for (EGLDisplay display : displays)
        if (createOn(display, sharedContext, problem)) return true;
    return false;
}

bool EglContext::createOn(void* display, void* sharedContext, std::string& problem)
{
    if (!eglInitialize(display, nullptr, nullptr)) {
        problem = "EGL cannot initialize a display";
        return false;
    }
    eglBindAPI(EGL_OPENGL_API);
    const EGLint configWish[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, configWish, &config, 1, &count) || count == 0) {
        problem = "EGL has no configuration for OpenGL";
        return false;
    }
    const EGLint contextWish[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 1, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext context = eglCreateContext(display, config, sharedContext, contextWish);
    if (context == EGL_NO_CONTEXT) {
        problem = "EGL cannot make an OpenGL 4.1 core context";
        return false;
    }
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        eglDestroyContext(display, context);
        problem = "EGL cannot use a context without a surface";
        return false;
    }
    display_ = display;
    context_ = context;
    return true;
}

void EglContext::destroy()
{
    if (!context_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    if (beforeContext_ != EGL_NO_CONTEXT) eglMakeCurrent(beforeDisplay_, beforeDraw_, beforeRead_, beforeContext_);
    // No eglTerminate: the display belongs to the process, and another server may use it.
    display_ = context_ = nullptr;
}

} // namespace filasofia::visual
