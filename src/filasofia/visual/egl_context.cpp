#include "filasofia/visual/egl_context.h"

#include "filasofia/core/text.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace filasofia::visual {
namespace {

/// EGL, which is loaded when it is first needed: a program that draws nothing runs where it is not installed.
class Egl {
    // Never closed: contexts of the process may outlive every server.
    void* library_ = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    int missing_ = library_ ? 0 : 1;

    template <class Function> Function load(const char* name)
    {
        void* const function = dlsym(library_, name);
        missing_ += function == nullptr;
        return reinterpret_cast<Function>(function);
    }

public:
    decltype(&eglBindAPI) bindApi = load<decltype(&eglBindAPI)>("eglBindAPI");
    decltype(&eglChooseConfig) chooseConfig = load<decltype(&eglChooseConfig)>("eglChooseConfig");
    decltype(&eglCreateContext) createContext = load<decltype(&eglCreateContext)>("eglCreateContext");
    decltype(&eglDestroyContext) destroyContext = load<decltype(&eglDestroyContext)>("eglDestroyContext");
    decltype(&eglGetCurrentContext) getCurrentContext = load<decltype(&eglGetCurrentContext)>("eglGetCurrentContext");
    decltype(&eglGetCurrentDisplay) getCurrentDisplay = load<decltype(&eglGetCurrentDisplay)>("eglGetCurrentDisplay");
    decltype(&eglGetCurrentSurface) getCurrentSurface = load<decltype(&eglGetCurrentSurface)>("eglGetCurrentSurface");
    decltype(&eglGetProcAddress) getProcAddress = load<decltype(&eglGetProcAddress)>("eglGetProcAddress");
    decltype(&eglInitialize) initialize = load<decltype(&eglInitialize)>("eglInitialize");
    decltype(&eglMakeCurrent) makeCurrent = load<decltype(&eglMakeCurrent)>("eglMakeCurrent");
    decltype(&eglQueryString) queryString = load<decltype(&eglQueryString)>("eglQueryString");
    bool found = missing_ == 0;
    /// OpenGL itself, too, without which libepoxy ends the process.
    bool foundOpenGl = dlopen("libGL.so.1", RTLD_LAZY | RTLD_LOCAL) || dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_LOCAL);
};

const Egl& egl()
{
    static const Egl loaded;
    return loaded;
}

bool hasExtension(const char* list, std::string_view name)
{
    return list && std::string_view(list).find(name) != std::string_view::npos;
}

/// Every display that needs no screen: the devices (graphics cards, then Mesa's software), then Mesa's surfaceless one.
std::vector<EGLDisplay> headlessDisplays()
{
    std::vector<EGLDisplay> displays;
    const char* extensions = egl().queryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto platformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl().getProcAddress("eglGetPlatformDisplayEXT"));
    if (!platformDisplay) return displays;
    const auto add = [&](EGLDisplay display) {
        if (display != EGL_NO_DISPLAY) displays.push_back(display);
    };
    const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl().getProcAddress("eglQueryDevicesEXT"));
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

EglContext::Address EglContext::address(const char* name) { return egl().getProcAddress(name); }

bool EglContext::create(void* sharedContext, std::string& problem)
{
    if (!egl().found || !egl().foundOpenGl) {
        const bool both = !egl().found && !egl().foundOpenGl;
        problem = text(egl().found ? "" : "'libEGL.so.1'", both ? " and " : "", egl().foundOpenGl ? "" : "'libGL.so.1'",
                       both ? " are" : " is", " not installed (Debian: libegl1, libgl1, libgl1-mesa-dri)");
        return false;
    }
    prepareMesa();
    beforeDisplay_ = egl().getCurrentDisplay();
    beforeContext_ = egl().getCurrentContext();
    beforeDraw_ = egl().getCurrentSurface(EGL_DRAW);
    beforeRead_ = egl().getCurrentSurface(EGL_READ);
    const std::vector<EGLDisplay> displays = headlessDisplays();
    if (displays.empty()) problem = "EGL offers no display that works without a screen";
    for (EGLDisplay display : displays)
        if (createOn(display, sharedContext, problem)) return true;
    return false;
}

bool EglContext::createOn(void* display, void* sharedContext, std::string& problem)
{
    if (!egl().initialize(display, nullptr, nullptr)) {
        problem = "EGL cannot initialize a display";
        return false;
    }
    egl().bindApi(EGL_OPENGL_API);
    const EGLint configWish[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!egl().chooseConfig(display, configWish, &config, 1, &count) || count == 0) {
        problem = "EGL has no configuration for OpenGL";
        return false;
    }
    const EGLint contextWish[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 1, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext context = egl().createContext(display, config, sharedContext, contextWish);
    if (context == EGL_NO_CONTEXT) {
        problem = "EGL cannot make an OpenGL 4.1 core context";
        return false;
    }
    if (!egl().makeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        egl().destroyContext(display, context);
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
    egl().makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl().destroyContext(display_, context_);
    if (beforeContext_ != EGL_NO_CONTEXT) egl().makeCurrent(beforeDisplay_, beforeDraw_, beforeRead_, beforeContext_);
    // No eglTerminate: the display belongs to the process, and another server may use it.
    display_ = context_ = nullptr;
}

} // namespace filasofia::visual
