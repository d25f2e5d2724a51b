#pragma once

#include "filasofia/visual/camera.h"

namespace filasofia::visual {

/// What a view spends on its picture.
enum class Quality {
    Low,    ///< no effects, no shadows: fast tests
    Medium, ///< shadows, tone mapping, vignette, smoothed edges
    High,   ///< and ambient occlusion, bloom
};

/// A rectangle of the window in fractions of it, from its upper left corner.
struct Viewport {
    double left = 0.0;   ///< [-], in [0, 1)
    double top = 0.0;    ///< [-], in [0, 1)
    double width = 1.0;  ///< [-], in (0, 1]; left + width <= 1
    double height = 1.0; ///< [-], in (0, 1]; top + height <= 1

    friend constexpr bool operator==(const Viewport&, const Viewport&) = default;
};

constexpr auto fields(const Viewport*)
{
    return describe("Viewport", field("left", &Viewport::left, "-", closedOpen(0, 1), "of the window's width"),
                    field("top", &Viewport::top, "-", closedOpen(0, 1), "of the window's height"),
                    field("width", &Viewport::width, "-", openClosed(0, 1), "of the window's width"),
                    field("height", &Viewport::height, "-", openClosed(0, 1), "of the window's height"));
}

struct ViewDef {
    std::string name = "view";
    Viewport viewport = {};
    Quality quality = Quality::High;
    double occlusionRadius = 0.012; ///< [m], > 0: how far corners darken their surroundings (Quality::High)
};

constexpr auto fields(const ViewDef*)
{
    return describe("ViewDef", field("name", &ViewDef::name, "name in errors"),
                    field("viewport", &ViewDef::viewport, "where in the window"),
                    field("quality", &ViewDef::quality, "what it spends on the picture"),
                    field("occlusionRadius", &ViewDef::occlusionRadius, "m", positive(), "reach of dark corners"));
}

/// Shows what a camera sees in a rectangle of the window; made by VisualServer::add. Later views lie on top.
class View {
public:
    struct Impl;
    explicit View(std::unique_ptr<Impl> impl);
    ~View();
    View(const View&) = delete;
    View& operator=(const View&) = delete;

    [[nodiscard]] const ViewDef& def() const;
    /// Throws an Error naming the view and the field that is out of range.
    void set(const ViewDef& def);
    [[nodiscard]] Camera& camera() const;
    /// Throws an Error when the camera belongs to another server.
    void setCamera(Camera& camera);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
