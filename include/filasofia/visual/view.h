#pragma once

#include "filasofia/visual/camera.h"
#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/effects.h"
#include "filasofia/visual/image.h"

#include <variant>

namespace filasofia::visual {

/// A rectangle of the window, as fractions of it from its upper left corner.
struct Viewport {
    double left = 0.0;   ///< [-], in [0, 1)
    double top = 0.0;    ///< [-], in [0, 1)
    double width = 1.0;  ///< [-], in (0, 1]; left + width <= 1
    double height = 1.0; ///< [-], in (0, 1]; top + height <= 1

    friend constexpr bool operator==(const Viewport&, const Viewport&) = default;
};

constexpr auto fields(const Viewport*)
{
    return describe("Viewport", field("left", &Viewport::left, "-", closedOpen(0, 1), "fraction of the window's width"),
                    field("top", &Viewport::top, "-", closedOpen(0, 1), "fraction of the window's height"),
                    field("width", &Viewport::width, "-", openClosed(0, 1), "fraction of the window's width"),
                    field("height", &Viewport::height, "-", openClosed(0, 1), "fraction of the window's height"));
}

/// The view is shown in the window.
struct InWindow {
    friend constexpr bool operator==(const InWindow&, const InWindow&) = default;
};

constexpr auto fields(const InWindow*) { return describe("InWindow"); }

/// The view has a picture of its own, which can be read (View::capture) or shown on a body (ViewPicture).
struct OffScreen {
    int width = 640;  ///< [px], in [1, 8192]
    int height = 480; ///< [px], in [1, 8192]

    friend constexpr bool operator==(const OffScreen&, const OffScreen&) = default;
};

constexpr auto fields(const OffScreen*)
{
    return describe("OffScreen", field("width", &OffScreen::width, "px", closed(1, 8192), "size of the picture"),
                    field("height", &OffScreen::height, "px", closed(1, 8192), "size of the picture"));
}

struct ViewDef {
    std::string name = "view"; ///< off-screen views of a server must have different names
    Viewport viewport = {};    ///< for a view in the window
    Quality quality = Quality::High;
    double occlusionRadius = 0.012;                ///< [m], > 0, reach of the darkening around corners (Quality::High)
    std::optional<Effects> effects = {};           ///< not given: those of `quality`
    std::variant<InWindow, OffScreen> target = {}; ///< where its picture goes
};

constexpr auto fields(const ViewDef*)
{
    return describe("ViewDef", field("name", &ViewDef::name, "name in errors"),
                    field("viewport", &ViewDef::viewport, "where in the window"),
                    field("quality", &ViewDef::quality, "effort for the picture"),
                    field("occlusionRadius", &ViewDef::occlusionRadius, "m", positive(), "reach of dark corners"),
                    field("effects", &ViewDef::effects, "in place of those of quality"),
                    field("target", &ViewDef::target, "where its picture goes"));
}

/// Shows what a camera sees, in a rectangle of the window or in a picture of its own; made by VisualServer::add. Every
/// frame draws first the off-screen views, then the window's, each in the order in which they were made, so that later
/// ones in the window lie on top. Main thread only.
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
    /// Throws an Error if the camera belongs to another server.
    void setCamera(Camera& camera);

    [[nodiscard]] bool visible() const;
    /// A hidden view is not drawn; the picture of an off-screen view stays as it was.
    void setVisible(bool visible);

    /// Draws this view with the present scene and returns its picture; earlier off-screen views are drawn too, because
    /// it may show them. Throws an Error if it is a view of the window (use VisualServer::capture), or if the graphics
    /// library gives no picture.
    Image capture();
    /// Depth and label of each pixel of this view, like VisualServer::captureDepth(). Throws an Error if it is a view
    /// of the window.
    DepthImage captureDepth();

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    void requireOffScreen(const char* instead) const;

    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
