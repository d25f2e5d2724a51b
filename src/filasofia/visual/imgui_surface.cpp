#include "filasofia/visual/imgui_surface.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/visual/imgui_style.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

extern "C" {
/// Called by ImGui's assertions in our copy of the library (cmake/FilasofiaImgui.cmake), in place of __assert_fail. It
/// throws through ImGui, which holds no resources there, to the frame that called the callback. It stands in this file
/// because a linker takes from a library only what is missing so far.
[[noreturn]] void filasofia_imgui_assertion(const char* assertion, const char* file, unsigned line, const char* where);
}

void filasofia_imgui_assertion(const char* assertion, const char* /*file*/, unsigned /*line*/, const char* where)
{
    filasofia::fail("ImGui was called wrongly: ", std::string_view(where), ": ", std::string_view(assertion));
}

namespace filasofia::visual {
namespace {

/// ImGui has one current context for the whole process, so servers of several threads take turns.
std::recursive_mutex imguiMutex;

class CurrentContext {
public:
    explicit CurrentContext(ImGuiContext* context) : lock_(imguiMutex), before_(ImGui::GetCurrentContext())
    {
        ImGui::SetCurrentContext(context);
    }
    ~CurrentContext() { ImGui::SetCurrentContext(before_); }
    CurrentContext(const CurrentContext&) = delete;
    CurrentContext& operator=(const CurrentContext&) = delete;

private:
    std::lock_guard<std::recursive_mutex> lock_;
    ImGuiContext* before_;
};

/// A new context in place of `old`, which may be null. ImGui makes a new context current if there is none.
ImGuiContext* replaced(ImGuiContext* old, ImFontAtlas* atlas)
{
    const std::lock_guard lock(imguiMutex);
    ImGuiContext* before = ImGui::GetCurrentContext();
    if (old) ImGui::DestroyContext(old);
    ImGuiContext* made = atlas ? ImGui::CreateContext(atlas) : nullptr;
    ImGui::SetCurrentContext(before && before == old ? made : before);
    return made;
}

/// ImGui reports what it had to end in printf style.
void collectRecovery(void* lines, const char* format, ...)
{
    char line[256];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    auto& all = *static_cast<std::string*>(lines);
    all += (all.empty() ? "" : "; ") + std::string(line);
}

GuiCommand commandOf(const ImDrawCmd& from, std::uint32_t firstIndex, int width, int height)
{
    const auto edge = [](float at, int limit) { return std::clamp(int(at), 0, limit); };
    GuiCommand command{firstIndex, from.ElemCount, {}};
    command.clip.left = edge(from.ClipRect.x, width);
    command.clip.top = edge(from.ClipRect.y, height);
    command.clip.right = std::max(edge(from.ClipRect.z, width), command.clip.left);
    command.clip.bottom = std::max(edge(from.ClipRect.w, height), command.clip.top);
    return command;
}

void append(const ImDrawList& list, int width, int height, GuiPicture& picture)
{
    const auto base = static_cast<std::uint32_t>(picture.vertices.size());
    for (const ImDrawVert& v : list.VtxBuffer) {
        const auto part = [&](unsigned shift) { return std::uint8_t((v.col >> shift) & 0xFFU); };
        picture.vertices.push_back(
            {v.pos.x,
             v.pos.y,
             v.uv.x,
             v.uv.y,
             {part(IM_COL32_R_SHIFT), part(IM_COL32_G_SHIFT), part(IM_COL32_B_SHIFT), part(IM_COL32_A_SHIFT)}});
    }
    for (const ImDrawCmd& each : list.CmdBuffer) {
        const GuiCommand command = commandOf(each, std::uint32_t(picture.indices.size()), width, height);
        // A callback of a draw list would call OpenGL directly, which is not possible here.
        if (each.UserCallback || each.ElemCount == 0 || command.clip.width() == 0 || command.clip.height() == 0)
            continue;
        picture.commands.push_back(command);
        for (unsigned i = 0; i < each.ElemCount; ++i)
            picture.indices.push_back(base + each.VtxOffset + list.IdxBuffer[int(each.IdxOffset + i)]);
    }
}

} // namespace

ImguiSurface::ImguiSurface(ImguiSurfaceDef def) : def_(std::move(def)), atlas_(std::make_unique<ImFontAtlas>())
{
    makeContext();
}

ImguiSurface::~ImguiSurface()
{
    callback.set({}); // its destructor may call ImGui
    replaced(context_, nullptr);
}

void ImguiSurface::makeContext()
{
    context_ = replaced(context_, atlas_.get());
    atlas_->Locked = false; // an aborted frame leaves it locked
    ImGuiIO& io = context_->IO;
    io.IniFilename = nullptr; // a simulator leaves no files in the folder where it was started
    io.LogFilename = nullptr;
    io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
    // The same input gives the same picture, and nothing flickers in a surgeon's view.
    io.ConfigInputTextCursorBlink = false;
    io.ConfigWindowsMoveFromTitleBarOnly = true; // a missed slider does not move the panel
    ImguiInput::mapKeys(io);
    if (scale_ > 0.0) context_->Style = themeOf(scale_);
}

bool ImguiSurface::setScale(double scale)
{
    if (scale == scale_) return false;
    const CurrentContext current(context_);
    scale_ = scale;
    context_->Style = themeOf(scale);
    glyphs_ = std::make_shared<const GlyphSheet>(rasterise(*atlas_, scale));
    return true;
}

bool ImguiSurface::wantsText() const { return context_->IO.WantTextInput; }

GuiPicture ImguiSurface::frame(int width, int height, double seconds)
{
    FILASOFIA_ASSERT(scale_ > 0.0 && width > 0 && height > 0);
    GuiPicture picture;
    const CurrentContext current(context_);
    ImGuiIO& io = context_->IO;
    io.DisplaySize = {float(width), float(height)};
    io.DeltaTime = float(std::clamp(seconds, 1e-4, 1.0)); // after a long pause nothing is repeated a thousand times
    input_.apply(io);
    try {
        ImGui::NewFrame();
        callUser(width, height);
        endFrame();
        collect(picture);
    } catch (const std::exception&
                 problem) { // an assertion: the callback has left a state that cannot be repaired by ending windows
        callback.call([](const RenderCallback&) { return false; });
        logError(def_.object, ": renderCallback: ", std::string_view(problem.what()),
                 "; it is not called again, and ImGui is restarted");
        picture = {};
        makeContext();
    }
    ++frames_;
    return picture;
}

void ImguiSurface::callUser(int width, int height)
{
    callback.call([&](const RenderCallback& user) {
        const auto draw = [&] {
            if (def_.fillingWindow) {
                ImGui::SetNextWindowPos({0, 0});
                ImGui::SetNextWindowSize({float(width), float(height)});
                ImGui::Begin("##canvas", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings);
            }
            user();
            if (def_.fillingWindow && context_->CurrentWindowStack.Size > 1) ImGui::End();
        };
        const std::optional<std::string> problem = guardedCall(draw);
        if (problem) logError(def_.object, ": renderCallback: ", *problem, "; it is not called again");
        return !problem;
    });
}

void ImguiSurface::endFrame()
{
    std::string ended;
    ImGui::ErrorCheckEndFrameRecover(&collectRecovery, &ended);
    if (!ended.empty() && !std::exchange(warned_, true)) logWarning(def_.object, ": renderCallback: ", ended);
    ImGui::Render();
}

void ImguiSurface::collect(GuiPicture& picture) const
{
    const ImDrawData& drawn = *ImGui::GetDrawData();
    for (int i = 0; i < drawn.CmdListsCount; ++i)
        append(*drawn.CmdLists[i], int(context_->IO.DisplaySize.x), int(context_->IO.DisplaySize.y), picture);
}

} // namespace filasofia::visual
