#pragma once

#include "filasofia/visual/filament_gui.h"

#include <filament/RenderTarget.h>

namespace filasofia::visual {

/// A Canvas: its picture is drawn into a texture with mipmaps, for distant and oblique views, and shown on a rectangle
/// in the scene.
class FilamentCanvas {
public:
    FilamentCanvas(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool, const CanvasSize& size);
    ~FilamentCanvas();
    FilamentCanvas(const FilamentCanvas&) = delete;
    FilamentCanvas& operator=(const FilamentCanvas&) = delete;

    void setGlyphs(std::shared_ptr<const GlyphSheet> glyphs) { gui_.setGlyphs(std::move(glyphs)); }
    void setPicture(const Pose& world, GuiPicture picture);
    /// Draws into the texture if the picture has changed; call it within a frame, before the views that show it.
    void draw(filament::Renderer& renderer);

private:
    void makeTarget(int pixelWidth, int pixelHeight);
    void makeSheet(double width, double height);

    filament::Engine& engine_;
    filament::Scene& scene_;
    FilamentGui gui_;
    utils::Entity sheet_;
    filament::Texture* picture_ = nullptr;
    filament::RenderTarget* target_ = nullptr;
    filament::VertexBuffer* corners_ = nullptr;
    filament::IndexBuffer* indices_ = nullptr;
    filament::MaterialInstance* instance_ = nullptr;
    bool changed_ = true;
    bool shown_ = false;
};

} // namespace filasofia::visual
