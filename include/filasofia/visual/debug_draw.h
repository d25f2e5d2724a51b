#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/math/pose.h"
#include "filasofia/visual/material.h"

#include <memory>
#include <string>

namespace filasofia::visual {

/// The style of a debug drawing.
struct DebugStyle {
    Color color = {1.0, 0.75, 0.1};
    double width = 2.0; ///< [px], in [0.5, 100], of lines and points
    bool onTop = false; ///< visible through everything; otherwise bodies hide it. Texts are always on top
    bool keep = false;  ///< drawn until clear(); otherwise in the next picture only
};

constexpr auto fields(const DebugStyle*)
{
    using D = DebugStyle;
    return describe("DebugStyle", field("color", &D::color, "color of lines, points and texts"),
                    field("width", &D::width, "px", closed(0.5, 100), "width of lines and points"),
                    field("onTop", &D::onTop, "visible through everything"),
                    field("keep", &D::keep, "until cleared; else for one picture"));
}

/// The size of the debug drawings.
struct DebugCounts {
    long vertices = 0; ///< vertices of lines, points and arrow heads
    long texts = 0;
};

/// Lines, points and texts in the scene, to show data: visible in every view and not lit. Belongs to a server
/// (VisualServer::debug); main thread only. All functions throw an Error if a number is not finite (below 1e6 m) or the
/// style is out of range.
class DebugDraw {
public:
    struct Impl;
    explicit DebugDraw(std::unique_ptr<Impl> impl);
    ~DebugDraw();
    DebugDraw(const DebugDraw&) = delete;
    DebugDraw& operator=(const DebugDraw&) = delete;

    void line(Vec3 from, Vec3 to, const DebugStyle& style = {});
    void point(Vec3 at, const DebugStyle& style = {.width = 6.0});
    /// A line with a cone at its end, a fifth of the whole length. An arrow without length is not drawn.
    void arrow(Vec3 from, Vec3 to, const DebugStyle& style = {});
    /// The axes of a pose, `length` [m] > 0 long: x red, y green, z blue, whatever the style's colour.
    void frame(const Pose& pose, double length, const DebugStyle& style = {});
    /// The edges of a box that is axis-aligned in the pose's coordinates. Error if it is empty.
    void box(const geometry::Box& box, const Pose& pose = {}, const DebugStyle& style = {});
    /// UTF-8 text with its upper left corner beside the point.
    void text(Vec3 at, std::string text, const DebugStyle& style = {});

    /// Removes all drawings, including kept ones.
    void clear();

    [[nodiscard]] DebugCounts counts() const;
    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
