#pragma once

#include "filasofia/visual/debug_draw.h"
#include "filasofia/visual/overlay_backend.h"

#include <string>

namespace filasofia::visual {

struct DebugText {
    Vec3 at;
    std::string text;
    Color color;
};

/// Debug drawings as triangles: those for one picture, and those that are kept.
class DebugShapes {
public:
    void line(Vec3 from, Vec3 to, const DebugStyle& style, const Color& color);
    void point(Vec3 at, const DebugStyle& style);
    void cone(Vec3 base, Vec3 tip, double radius, const DebugStyle& style);
    void text(DebugText text, bool keep);
    void clear();

    /// All present drawings.
    [[nodiscard]] DebugPicture picture() const;
    [[nodiscard]] std::vector<DebugText> texts() const;
    [[nodiscard]] DebugCounts counts() const;
    /// Removes the drawings that are not to be kept.
    void endFrame();

private:
    struct Set {
        DebugPicture picture;
        std::vector<DebugText> texts;
    };
    DebugLayer& layerOf(const DebugStyle& style);

    Set once_, kept_;
};

struct DebugDraw::Impl {
    DebugShapes shapes;
};

} // namespace filasofia::visual
