#pragma once

#include <string>

namespace filasofia::visual {

/// An OpenGL 4.1 core context without window or surface, through EGL. Tries hardware first, then software.
class EglContext {
public:
    EglContext() = default;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    ~EglContext() { destroy(); }

    /// Makes the context and makes it current in this thread. Returns false and sets `problem` if it cannot; throws
    /// only if memory runs out.
    bool create(void* sharedContext, std::string& problem);
    /// Makes current again what was current before create().
    void destroy();

    /// An OpenGL function by name.
    template <class Function> static Function* function(const char* name)
    {
        return reinterpret_cast<Function*>(address(name));
    }

private:
    using Address = void (*)();
    static Address address(const char* name);
    bool createOn(void* display, void* sharedContext, std::string& problem);

    void* display_ = nullptr;
    void* context_ = nullptr;
    // Current before create(); destroy() restores it.
    void* beforeDisplay_ = nullptr;
    void* beforeContext_ = nullptr;
    void* beforeDraw_ = nullptr;
    void* beforeRead_ = nullptr;
};

/// Call it before the process makes its first OpenGL context. Mesa 22's framebuffer fetch garbles Filament's
/// post-processing, so it is switched off here, unless the user's environment says otherwise.
void prepareMesa();

} // namespace filasofia::visual
