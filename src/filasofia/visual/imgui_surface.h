#pragma once

#include "filasofia/visual/imgui_input.h"
#include "filasofia/visual/overlay_backend.h"
#include "filasofia/visual/render_callback.h"

#include <string>

struct ImFontAtlas;
struct ImGuiContext;

namespace filasofia::visual {

/// The name of a surface, and how each frame begins.
struct ImguiSurfaceDef {
    std::string object;         ///< "gui 'panel'", as errors and the log name it
    bool fillingWindow = false; ///< the callback draws into one window that fills the surface
};

/// One ImGui context: the implementation of a Gui or a Canvas. Draws nothing; turns a callback into triangles.
class ImguiSurface {
public:
    explicit ImguiSurface(ImguiSurfaceDef def);
    ~ImguiSurface();
    ImguiSurface(const ImguiSurface&) = delete;
    ImguiSurface& operator=(const ImguiSurface&) = delete;

    GuardedCallback callback;

    /// Sets the scale of text and spacing. Returns true if the glyphs have changed.
    bool setScale(double scale);
    [[nodiscard]] const std::shared_ptr<const GlyphSheet>& glyphs() const { return glyphs_; }

    /// One frame of `seconds` on width x height pixels.
    GuiPicture frame(int width, int height, double seconds);
    [[nodiscard]] long frames() const { return frames_; }

    /// See ImguiInput.
    bool take(const event::Event& event, double x, double y) { return input_.take(event, x, y, *context_); }
    [[nodiscard]] bool wantsText() const; ///< somebody writes into one of its fields
    void leave() { input_.leave(); }
    void releaseAll() { input_.releaseAll(); }
    [[nodiscard]] std::size_t inputsWaiting() const { return input_.waiting(); }

private:
    void makeContext();
    void callUser(int width, int height);
    /// Ends what the callback has not ended, and the frame.
    void endFrame();
    void collect(GuiPicture& picture) const;

    ImguiSurfaceDef def_;
    std::unique_ptr<ImFontAtlas> atlas_;
    ImGuiContext* context_ = nullptr;
    std::shared_ptr<const GlyphSheet> glyphs_;
    ImguiInput input_;
    double scale_ = 0.0;
    long frames_ = 0;
    bool warned_ = false; ///< about something that the callback did not end
};

} // namespace filasofia::visual
