#pragma once

#include "filasofia/visual/material_pool.h"
#include "filasofia/visual/overlay_backend.h"

#include <filament/Camera.h>
#include <filament/IndexBuffer.h>
#include <filament/Renderer.h>
#include <filament/Scene.h>
#include <filament/Texture.h>
#include <filament/VertexBuffer.h>
#include <filament/View.h>
#include <filament/Viewport.h>
#include <utils/Entity.h>

namespace filasofia::visual {

/// Draws the triangles of a Gui or Canvas in a view of its own, whose coordinates are pixels.
class FilamentGui {
public:
    FilamentGui(filament::Engine& engine, MaterialPool& pool);
    ~FilamentGui();
    FilamentGui(const FilamentGui&) = delete;
    FilamentGui& operator=(const FilamentGui&) = delete;

    void setGlyphs(std::shared_ptr<const GlyphSheet> glyphs);
    /// Returns false if this picture is already shown.
    bool setPicture(GuiPicture picture);
    /// The view's pixels in its target, with rows counted from below.
    void setViewport(const filament::Viewport& pixels);
    [[nodiscard]] bool empty() const { return picture_.commands.empty(); }
    [[nodiscard]] filament::View& view() { return *view_; }

private:
    void upload();
    void growBuffers();
    void buildRenderable();
    void setScissors();

    filament::Engine& engine_;
    MaterialPool& pool_;
    filament::Scene* scene_;
    filament::View* view_;
    filament::Camera* camera_;
    utils::Entity eye_;
    utils::Entity triangles_;
    filament::Texture* glyphs_ = nullptr;
    filament::VertexBuffer* vertices_ = nullptr;
    filament::IndexBuffer* indices_ = nullptr;
    std::size_t vertexRoom_ = 0, indexRoom_ = 0;
    std::vector<filament::MaterialInstance*> instances_; ///< one per command, because each has its own rectangle
    GuiPicture picture_;
    filament::Viewport pixels_ = {0, 0, 1, 1};
};

} // namespace filasofia::visual
