#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/visual/float3.h"
#include "filasofia/visual/pixel_area.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace filasofia::visual {

using Slot = std::uint32_t; // as in render_backend.h

/// Number of elements to allocate for `count`: with reserve, because overlays grow and shrink all the time.
constexpr std::size_t roomFor(std::size_t count) { return count + count / 2 + 256; }

/// The glyphs of a Gui or Canvas: the coverage of each pixel of the sheet, in 255ths.
struct GlyphSheet {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> coverage; ///< width height bytes
};

/// One corner of a triangle of a Gui.
struct GuiVertex {
    float x = 0, y = 0;                     ///< [px], from the upper left corner
    float u = 0, v = 0;                     ///< place in the glyph sheet
    std::array<std::uint8_t, 4> color = {}; ///< sRGB and opacity

    friend bool operator==(const GuiVertex&, const GuiVertex&) = default;
};

/// Triangles that are drawn inside one rectangle.
struct GuiCommand {
    std::uint32_t firstIndex = 0;
    std::uint32_t indexCount = 0;
    PixelArea clip = {};

    friend bool operator==(const GuiCommand&, const GuiCommand&) = default;
};

/// What a Gui or Canvas looks like in a frame.
struct GuiPicture {
    std::vector<GuiVertex> vertices;
    std::vector<std::uint32_t> indices; ///< three per triangle
    std::vector<GuiCommand> commands;   ///< drawn in this order

    friend bool operator==(const GuiPicture&, const GuiPicture&) = default;
};

/// One corner of a debug drawing. Lines and points have a width in pixels in every view, so their corners are moved
/// apart when they are drawn.
struct DebugVertex {
    Float3 position;                        ///< [m]
    Float3 other;                           ///< [m], for a line: a point further along it
    float width = 0;                        ///< [px]; 0: the corner stays where it is (arrow heads)
    std::array<std::int8_t, 2> side = {};   ///< line: -1 or 1, and 0; point: -1 or 1 both
    std::array<std::uint8_t, 4> color = {}; ///< linear
};

/// Triangles of debug drawings, in two layers: one hidden by bodies, one on top.
struct DebugLayer {
    std::vector<DebugVertex> vertices;
    std::vector<std::uint32_t> indices;
};
struct DebugPicture {
    DebugLayer inside, onTop;
};

/// The size of a Canvas in the scene and of its texture.
struct CanvasSize {
    double width = 0.0;  ///< [m]
    double height = 0.0; ///< [m]
    int pixelWidth = 0;  ///< [px]
    int pixelHeight = 0; ///< [px]
};

/// Draws what lies over the scene, or stands in it and is not a body. Its input has been checked.
class OverlayBackend {
public:
    OverlayBackend() = default;
    OverlayBackend(const OverlayBackend&) = delete;
    OverlayBackend& operator=(const OverlayBackend&) = delete;
    virtual ~OverlayBackend() = default;

    /// Make one, or give it other glyphs.
    virtual void putGui(Slot slot, std::shared_ptr<const GlyphSheet> glyphs) = 0;
    virtual void putCanvas(Slot slot, const CanvasSize& size, std::shared_ptr<const GlyphSheet> glyphs) = 0;

    virtual void setGuiPicture(Slot gui, const PixelArea& area, GuiPicture picture) = 0; ///< `area` of the window
    virtual void setCanvasPicture(Slot canvas, const Pose& world, GuiPicture picture) = 0;
    virtual void setDebug(const DebugPicture& picture) = 0;
    virtual void remove(Slot slot) = 0;
};

} // namespace filasofia::visual
