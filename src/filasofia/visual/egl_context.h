#pragma once

#include <string>

namespace filasofia::visual {

/// An OpenGL 4.1 core context without window or surface, through EGL. Hardware first, then software.
class EglContext {
public:
    EglContext() = default;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;
    ~EglContext() { destroy(); }

    /// Makes the context and makes it current in this thread. False, and `problem` says why, when it cannot; never
    /// throws but for lack of memory.
    bool create(void* sharedContext, std::string& problem);
    /// What was current before create() is current again.
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
    // What was current before create(): destroy() brings it back.
    void* beforeDisplay_ = nullptr;
    void* beforeContext_ = nullptr;
    void* beforeDraw_ = nullptr;
    void* beforeRead_ = nullptr;
};

/// To be called before the process makes its first OpenGL context. Mesa 22's framebuffer fetch garbles Filament's
/// post-processing: it is switched off here, unless the user's environment says otherwise.
void prepareMesa();

} // namespace filasofia::visual
