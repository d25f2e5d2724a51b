#include "filasofia/visual/imgui_style.h"

#include <imgui.h>

#include <cmath>
#include <cstring>

namespace filasofia::visual {
namespace embedded { // made by materials/embed.cmake
extern const std::uint8_t font[];
extern const std::size_t fontSize;
} // namespace embedded

namespace {

constexpr double kFontSize = 15.0; // [px] at scale 1

/// 0xRRGGBB, as colours are written everywhere, and an opacity.
ImVec4 shade(unsigned rgb, float opacity = 1.0F)
{
    const auto part = [&](unsigned shift) { return float((rgb >> shift) & 0xFFU) / 255.0F; };
    return {part(16), part(8), part(0), opacity};
}

// Near black with a breath of blue, so that the warm picture stays the brightest thing; one accent for all that is
// active.
constexpr unsigned kGround = 0x14171A, kRaised = 0x23282D, kHover = 0x323A41, kAccent = 0x2FA4A8, kBright = 0x4CC9CC;
constexpr unsigned kText = 0xE4E8EA, kFaint = 0x7C868D, kEdge = 0x39424A, kWarm = 0xE8A33D;

void setColors(ImVec4* colors)
{
    colors[ImGuiCol_Text] = shade(kText);
    colors[ImGuiCol_TextDisabled] = shade(kFaint);
    colors[ImGuiCol_WindowBg] = shade(kGround, 0.94F);
    colors[ImGuiCol_ChildBg] = shade(kGround, 0.0F);
    colors[ImGuiCol_PopupBg] = shade(kGround, 0.98F);
    colors[ImGuiCol_Border] = shade(kEdge);
    colors[ImGuiCol_BorderShadow] = shade(0, 0.0F);
    for (const int raised : {ImGuiCol_FrameBg, ImGuiCol_Button, ImGuiCol_Header, ImGuiCol_Tab})
        colors[raised] = shade(kRaised);
    for (const int hovered : {ImGuiCol_FrameBgHovered, ImGuiCol_ButtonHovered, ImGuiCol_HeaderHovered})
        colors[hovered] = shade(kHover);
    for (const int active : {ImGuiCol_FrameBgActive, ImGuiCol_ButtonActive, ImGuiCol_HeaderActive})
        colors[active] = shade(kAccent, 0.75F);
    for (const int accent : {ImGuiCol_CheckMark, ImGuiCol_SliderGrab, ImGuiCol_PlotLines, ImGuiCol_SeparatorActive,
                             ImGuiCol_ResizeGripActive, ImGuiCol_NavHighlight})
        colors[accent] = shade(kAccent);
    for (const int bright : {ImGuiCol_SliderGrabActive, ImGuiCol_PlotLinesHovered, ImGuiCol_DragDropTarget})
        colors[bright] = shade(kBright);
    colors[ImGuiCol_PlotHistogram] = shade(kWarm);
    colors[ImGuiCol_PlotHistogramHovered] = shade(kText);
    colors[ImGuiCol_TextSelectedBg] = shade(kAccent, 0.45F);
    colors[ImGuiCol_TitleBg] = shade(0x1B2024);
    colors[ImGuiCol_TitleBgActive] = shade(0x1F3538);
    colors[ImGuiCol_TitleBgCollapsed] = shade(0x1B2024, 0.8F);
    colors[ImGuiCol_MenuBarBg] = shade(0x1B2024);
    colors[ImGuiCol_ScrollbarBg] = shade(kGround, 0.0F);
    colors[ImGuiCol_ScrollbarGrab] = shade(kHover);
    colors[ImGuiCol_ScrollbarGrabHovered] = shade(kFaint);
    colors[ImGuiCol_ScrollbarGrabActive] = shade(kAccent);
    colors[ImGuiCol_Separator] = shade(kEdge);
    colors[ImGuiCol_SeparatorHovered] = shade(kFaint);
    colors[ImGuiCol_ResizeGrip] = shade(kEdge);
    colors[ImGuiCol_ResizeGripHovered] = shade(kFaint);
    colors[ImGuiCol_TabHovered] = shade(kHover);
    colors[ImGuiCol_TabActive] = shade(0x1F5A5D);
    colors[ImGuiCol_TabUnfocused] = shade(kRaised);
    colors[ImGuiCol_TabUnfocusedActive] = shade(0x1F4244);
    colors[ImGuiCol_TableHeaderBg] = shade(kRaised);
    colors[ImGuiCol_TableBorderStrong] = shade(kEdge);
    colors[ImGuiCol_TableBorderLight] = shade(kEdge, 0.5F);
    colors[ImGuiCol_TableRowBg] = shade(0, 0.0F);
    colors[ImGuiCol_TableRowBgAlt] = shade(0xFFFFFF, 0.025F);
    colors[ImGuiCol_ModalWindowDimBg] = shade(0, 0.5F);
}

} // namespace

ImGuiStyle themeOf(double scale)
{
    ImGuiStyle style;
    setColors(style.Colors);
    style.WindowPadding = {12, 10};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 6};
    style.ItemInnerSpacing = {6, 4};
    style.WindowRounding = 6;
    style.ChildRounding = style.FrameRounding = style.PopupRounding = style.GrabRounding = style.TabRounding = 4;
    style.ScrollbarSize = 12;
    style.ScrollbarRounding = 6;
    style.GrabMinSize = 12;
    style.WindowTitleAlign = {0.5F, 0.5F};
    style.WindowMenuButtonPosition = ImGuiDir_None;
    style.ScaleAllSizes(float(scale));
    style.WindowBorderSize = style.PopupBorderSize = 1; // a hairline stays one
    return style;
}

GlyphSheet rasterise(ImFontAtlas& atlas, double scale)
{
    // Latin with all its accents, Greek for symbols, Cyrillic, dashes and quotation marks, arrows, comparisons.
    static constexpr ImWchar kLetters[] = {0x0020, 0x007E, 0x00A0, 0x017F, 0x0370, 0x03FF, 0x0400, 0x045F, 0x2010,
                                           0x203A, 0x20AC, 0x20AC, 0x2190, 0x2199, 0x2206, 0x2206, 0x2211, 0x2211,
                                           0x221A, 0x221E, 0x2248, 0x2248, 0x2260, 0x2265, 0};
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false; // it is a constant of the library
    config.OversampleH = 2;
    config.OversampleV = 1;
    config.PixelSnapH = true; // stems on pixels
    std::strncpy(config.Name, "DejaVu Sans", sizeof config.Name - 1);
    atlas.Clear();
    atlas.Flags |= ImFontAtlasFlags_NoMouseCursors;
    atlas.AddFontFromMemoryTTF(const_cast<std::uint8_t*>(embedded::font), int(embedded::fontSize),
                               float(std::round(kFontSize * scale)), &config, kLetters);
    unsigned char* pixels = nullptr;
    GlyphSheet sheet;
    atlas.GetTexDataAsAlpha8(&pixels, &sheet.width, &sheet.height);
    sheet.coverage.assign(pixels, pixels + std::size_t(sheet.width) * std::size_t(sheet.height));
    atlas.ClearTexData();
    return sheet;
}

} // namespace filasofia::visual
