#pragma once

#include "filasofia/visual/gui.h"
#include "filasofia/visual/transform.h"

namespace filasofia::visual {

struct CanvasDef {
    std::string name = "canvas";
    double width = 0.1;    ///< [m], in (0, 1e4]
    double height = 0.075; ///< [m], in (0, 1e4]
    int pixelWidth = 512;  ///< [px], in [16, 4096]
    int pixelHeight = 384; ///< [px], in [16, 4096]
    double scale = 1.0;    ///< [-], in [0.5, 8], size of text and spacing
    bool window = true;    ///< true: the callback draws into a window that fills the canvas; false: it begins its own
                           ///< windows, and the rest is transparent
    RenderCallback renderCallback = {}; ///< not a field of files; empty: nothing is drawn
};

constexpr auto fields(const CanvasDef*)
{
    using D = CanvasDef;
    return describe("CanvasDef", field("name", &D::name, "name in errors"),
                    field("width", &D::width, "m", openClosed(0, 1e4), "in the scene"),
                    field("height", &D::height, "m", openClosed(0, 1e4), "in the scene"),
                    field("pixelWidth", &D::pixelWidth, "px", closed(16, 4096), "resolution"),
                    field("pixelHeight", &D::pixelHeight, "px", closed(16, 4096), "resolution"),
                    field("scale", &D::scale, "-", closed(0.5, 8), "size of text and spacing"),
                    field("window", &D::window, "whether a window fills it"));
}

/// A sheet in the scene that ImGui draws on: centred at the origin of its pose, x to the right, y up, visible from +z
/// and, mirrored, from behind. It can have any Transform as parent, is hidden by bodies in front of it, is not lit and
/// takes no input. Made by VisualServer::add. Main thread only, except for setRenderCallback().
class Canvas final : public Transform {
public:
    struct Impl;
    Canvas(std::string name, std::unique_ptr<Impl> impl);
    ~Canvas() override;

    [[nodiscard]] const CanvasDef& def() const;

    /// Any thread; see Gui::setRenderCallback(). The callback of a hidden canvas is not called.
    void setRenderCallback(RenderCallback callback);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
