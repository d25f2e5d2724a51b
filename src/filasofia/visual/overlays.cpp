#include "filasofia/visual/overlays.h"

#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/debug_shapes.h"

#include <algorithm>

namespace filasofia::visual {
namespace {

constexpr double kMinTextScale = 0.5, kMaxTextScale = 8.0; // scales of text

bool isMouse(const event::Event& event)
{
    using event::EventType;
    return event.type == EventType::MouseMove || event.type == EventType::MouseButton ||
           event.type == EventType::MouseWheel;
}

PixelArea areaOf(const View* view, int width, int height)
{
    return pixelArea(view ? view->def().viewport : Viewport{}, width, height);
}

/// Sets a flag while it lives.
class FlagGuard {
public:
    explicit FlagGuard(bool& flag) : flag_(flag) { flag_ = true; }
    ~FlagGuard() { flag_ = false; }
    FlagGuard(const FlagGuard&) = delete;
    FlagGuard& operator=(const FlagGuard&) = delete;

private:
    bool& flag_;
};

} // namespace

Overlays::Overlays() : debug_(std::make_unique<DebugDraw>(std::make_unique<DebugDraw::Impl>())) {}
Overlays::~Overlays() = default;

Gui& Overlays::add(const GuiDef& def, View* view, Slot slot, OverlayBackend& backend, int width, int height)
{
    const std::string object = text("gui '", def.name, "'");
    validate(def, object);
    auto gui = std::make_unique<Gui>(std::unique_ptr<Gui::Impl>(
        new Gui::Impl{backend, slot, def, view, ImguiSurface({.object = object}), areaOf(view, width, height)}));
    ImguiSurface& surface = gui->impl().surface;
    surface.callback.set(def.renderCallback);
    surface.setScale(std::clamp(def.scale * guiScale_, kMinTextScale, kMaxTextScale));
    backend.putGui(slot, surface.glyphs());
    guis_.push_back(std::move(gui));
    return *guis_.back();
}

Canvas& Overlays::add(const CanvasDef& def, Slot slot, OverlayBackend& backend)
{
    const std::string object = text("canvas '", def.name, "'");
    validate(def, object);
    auto canvas = std::make_unique<Canvas>(
        def.name, std::unique_ptr<Canvas::Impl>(new Canvas::Impl{
                      backend, slot, def, ImguiSurface({.object = object, .fillingWindow = def.window})}));
    ImguiSurface& surface = canvas->impl().surface;
    surface.callback.set(def.renderCallback);
    surface.setScale(def.scale);
    backend.putCanvas(slot, {def.width, def.height, def.pixelWidth, def.pixelHeight}, surface.glyphs());
    canvases_.push_back(std::move(canvas));
    return *canvases_.back();
}

bool Overlays::remove(Gui& gui)
{
    const auto found = std::find_if(guis_.begin(), guis_.end(), [&](const auto& each) { return each.get() == &gui; });
    if (found == guis_.end()) return false;
    gui.impl().backend.remove(gui.impl().slot);
    guis_.erase(found);
    return true;
}

bool Overlays::remove(Transform& canvas)
{
    const auto found =
        std::find_if(canvases_.begin(), canvases_.end(), [&](const auto& each) { return each.get() == &canvas; });
    if (found == canvases_.end()) return false;
    (*found)->impl().backend.remove((*found)->impl().slot);
    canvases_.erase(found);
    return true;
}

bool Overlays::has(const Transform& canvas) const
{
    return std::ranges::any_of(canvases_, [&](const auto& each) { return each.get() == &canvas; });
}

void Overlays::checkRemoval(const View& view) const
{
    for (const auto& gui : guis_)
        if (gui->view() == &view)
            fail("view '", view.def().name, "' cannot be removed: gui '", gui->name(), "' lies on it");
}

void Overlays::checkNotCalled(const char* function) const
{
    if (calling_) fail("visual server: ", function, "() must not be called from a renderCallback");
}

void Overlays::setGuiScale(double scale)
{
    if (!(scale >= kMinTextScale && scale <= kMaxTextScale))
        fail("visual server: guiScale must be in [0.5, 8], got ", scale);
    guiScale_ = scale; // each Gui applies it in its next frame
}

bool Overlays::handle(const event::Event& event)
{
    bool taken = false;
    for (auto gui = guis_.rbegin(); gui != guis_.rend(); ++gui) {
        if (taken && isMouse(event)) {
            (*gui)->impl().surface.leave(); // a panel above covers it
        } else if (!taken || event.type == event::EventType::Window) {
            taken = (*gui)->handle(event) || taken;
        }
    }
    return taken;
}

bool Overlays::wantsText() const
{
    return std::any_of(guis_.begin(), guis_.end(),
                       [](const auto& gui) { return gui->visible() && gui->impl().surface.wantsText(); });
}

void Overlays::drawGui(Gui& gui, int width, int height, double seconds)
{
    Gui::Impl& impl = gui.impl();
    impl.area = areaOf(impl.view, width, height);
    if (impl.surface.setScale(std::clamp(impl.def.scale * guiScale_, kMinTextScale, kMaxTextScale)))
        impl.backend.putGui(impl.slot, impl.surface.glyphs());
    GuiPicture picture;
    if (impl.visible) picture = impl.surface.frame(impl.area.width(), impl.area.height(), seconds);
    impl.backend.setGuiPicture(impl.slot, impl.area, std::move(picture));
}

void Overlays::drawCanvas(Canvas& canvas, double seconds)
{
    Canvas::Impl& impl = canvas.impl();
    GuiPicture picture;
    if (canvas.worldVisible()) picture = impl.surface.frame(impl.def.pixelWidth, impl.def.pixelHeight, seconds);
    impl.backend.setCanvasPicture(impl.slot, canvas.worldPose(), std::move(picture));
}

void Overlays::callAll(int width, int height, double seconds)
{
    const FlagGuard guard(calling_);
    for (const auto& canvas : canvases_) drawCanvas(*canvas, seconds);
    for (const auto& gui : guis_) drawGui(*gui, width, height, seconds);
}

void Overlays::draw(OverlayBackend& backend, std::span<const std::unique_ptr<View>> views, int width, int height,
                    double seconds)
{
    const bool first = fresh(); // ImGui hides a window while it measures it
    for (int frame = first ? 0 : 2; frame < 3; ++frame) callAll(width, height, seconds);
    DebugShapes& shapes = debug_->impl().shapes;
    backend.setDebug(shapes.picture());
    debugTexts_.draw(backend, shapes.texts(), views, width, height, guiScale_);
    shapes.endFrame();
}

bool Overlays::fresh() const
{
    const auto unseen = [](const auto& each) {
        return each->impl().surface.frames() == 0 && !each->impl().surface.callback.empty();
    };
    return std::ranges::any_of(guis_, [&](const auto& gui) { return gui->visible() && unseen(gui); }) ||
           std::ranges::any_of(canvases_, [&](const auto& canvas) { return canvas->worldVisible() && unseen(canvas); });
}

} // namespace filasofia::visual
