#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/math/pose.h"
#include "filasofia/visual/material.h"

#include <memory>
#include <string>

namespace filasofia::visual {

/// How a debug drawing looks.
struct DebugStyle {
    Color color = {1.0, 0.75, 0.1};
    double width = 2.0; ///< [px], in [0.5, 100], of lines and points
    bool onTop = false; ///< seen through everything; else bodies hide it. Texts are always on top
    bool keep = false;  ///< until clear(); else it is in the next picture only
};

constexpr auto fields(const DebugStyle*)
{
    using D = DebugStyle;
    return describe("DebugStyle", field("color", &D::color, "of lines, points and texts"),
                    field("width", &D::width, "px", closed(0.5, 100), "of lines and points"),
                    field("onTop", &D::onTop, "seen through everything"),
                    field("keep", &D::keep, "until cleared; else for one picture"));
}

/// What is drawn of debug drawings.
struct DebugCounts {
    long vertices = 0; ///< of lines, points and arrow heads
    long texts = 0;
};

/// Lines, points and texts in the scene, for whoever wants to see numbers: seen in every view, lit by nothing. Of a
/// server (VisualServer::debug); main thread only. All throw an Error where a number is not finite (below 1e6 m) or the
/// style out of range.
class DebugDraw {
public:
    struct Impl;
    explicit DebugDraw(std::unique_ptr<Impl> impl);
    ~DebugDraw();
    DebugDraw(const DebugDraw&) = delete;
    DebugDraw& operator=(const DebugDraw&) = delete;

    void line(Vec3 from, Vec3 to, const DebugStyle& style = {});
    void point(Vec3 at, const DebugStyle& style = {.width = 6.0});
    /// A line with a cone at its end, a fifth of the whole length. One of no length is not drawn.
    void arrow(Vec3 from, Vec3 to, const DebugStyle& style = {});
    /// The axes of a pose, `length` [m] > 0: x red, y green, z blue, whatever the style's colour.
    void frame(const Pose& pose, double length, const DebugStyle& style = {});
    /// The edges of a box that is axis-aligned in the pose's coordinates. Error where it is empty.
    void box(const geometry::Box& box, const Pose& pose = {}, const DebugStyle& style = {});
    /// UTF-8, its left upper corner beside the point.
    void text(Vec3 at, std::string text, const DebugStyle& style = {});

    /// Forgets everything, also what was to be kept.
    void clear();

    [[nodiscard]] DebugCounts counts() const;
    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
