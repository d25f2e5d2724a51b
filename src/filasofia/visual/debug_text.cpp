#include "filasofia/visual/debug_text.h"

#include "filasofia/visual/scene.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace filasofia::visual {
namespace {

/// Converts our linear colours to ImGui's sRGB.
ImU32 encoded(const Color& color)
{
    const auto part = [](double linear) {
        const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
        return int(std::lround(255.0 * srgb));
    };
    return IM_COL32(part(color.red), part(color.green), part(color.blue), 255);
}

void drawTexts(std::span<const DebugText> texts, const View& view, int width, int height)
{
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const DebugText& text : texts) {
        const auto place = projected(view, width, height, text.at);
        if (!place) continue;
        const ImVec2 at{float(std::floor((*place)[0])) + 5.0F, float(std::floor((*place)[1])) + 3.0F};
        list.AddText({at.x + 1.0F, at.y + 1.0F}, IM_COL32(0, 0, 0, 200),
                     text.text.c_str()); // a shadow, readable on any background
        list.AddText(at, encoded(text.color), text.text.c_str());
    }
}

bool inWindow(const View& view) { return view.visible() && !std::holds_alternative<OffScreen>(view.def().target); }

} // namespace

std::optional<std::array<double, 2>> projected(const View& view, int width, int height, Vec3 point)
{
    const Camera& camera = view.camera();
    const Vec3 p = transform(inverse(camera.worldPose()), point);
    if (!(-p.z > camera.def().near && -p.z < camera.def().far)) return std::nullopt;
    const double pixels =
        0.5 * height / (std::tan(0.5 * camera.def().verticalFieldOfView) * -p.z); // [px/m] at that depth
    return std::array<double, 2>{0.5 * width + pixels * p.x, 0.5 * height - pixels * p.y};
}

void DebugTexts::draw(OverlayBackend& backend, std::span<const DebugText> texts,
                      std::span<const std::unique_ptr<View>> views, int width, int height, double scale)
{
    const auto shown = [&](Slot slot) {
        return std::any_of(views.begin(), views.end(),
                           [&](const auto& view) { return view->impl().slot == slot && inWindow(*view); });
    };
    for (auto sheet = sheets_.begin(); sheet != sheets_.end();) { // removes sheets of views that are gone
        if (shown(sheet->first)) {
            ++sheet;
        } else {
            backend.remove(sheet->first);
            sheet = sheets_.erase(sheet);
        }
    }
    for (const auto& each : views) {
        View& view = *each;
        const Slot slot = view.impl().slot; // no Gui has it, because slots are given once
        if (!inWindow(view)) continue;
        if (texts.empty() && !sheets_.contains(slot)) continue;
        ImguiSurface& surface = sheets_[slot].surface;
        if (surface.setScale(scale)) backend.putGui(slot, surface.glyphs());
        const PixelArea area = pixelArea(view.def().viewport, width, height);
        surface.callback.set([&] { drawTexts(texts, view, area.width(), area.height()); });
        backend.setGuiPicture(slot, area, surface.frame(area.width(), area.height(), 1.0 / 60.0));
        surface.callback.set({}); // it refers to local variables
    }
}

} // namespace filasofia::visual
