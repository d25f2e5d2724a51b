#pragma once

#include "filasofia/visual/effects.h"
#include "filasofia/visual/material_pool.h"

#include <filament/Camera.h>
#include <filament/IndexBuffer.h>
#include <filament/RenderTarget.h>
#include <filament/Scene.h>
#include <filament/VertexBuffer.h>
#include <filament/View.h>
#include <utils/Entity.h>

namespace filasofia::visual {

/// A texture that a view draws into, with the first row at the bottom.
class DrawnPicture {
public:
    enum class Content {
        Colours, ///< finished, sRGB encoded
        Light,   ///< linear and unbounded, and how opaque it is
        Numbers, ///< two floats per pixel, drawn without post-processing: so it has a depth buffer of its own
    };
    DrawnPicture(filament::Engine& engine, int width, int height, Content content = Content::Colours);
    DrawnPicture(const DrawnPicture&) = delete;
    DrawnPicture& operator=(const DrawnPicture&) = delete;
    ~DrawnPicture();

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] filament::Texture* texture() const { return texture_; }
    [[nodiscard]] filament::RenderTarget* target() const { return target_; }

private:
    filament::Engine& engine_;
    int width_;
    int height_;
    filament::Texture* texture_;
    filament::Texture* nearest_ = nullptr; ///< the depth buffer
    filament::RenderTarget* target_;
};

/// Endoscope optics as a second pass: the scene is drawn into a picture, which one triangle then shows as through the
/// lens.
class OpticsPass {
public:
    OpticsPass(filament::Engine& engine, MaterialPool& pool);
    OpticsPass(const OpticsPass&) = delete;
    OpticsPass& operator=(const OpticsPass&) = delete;
    ~OpticsPass();

    /// Sets size and optics, before the frame begins.
    void prepare(int width, int height, const EndoscopeOptics& optics);
    /// The picture to draw the scene into.
    [[nodiscard]] const DrawnPicture& picture() const { return *picture_; }
    /// The view that shows that picture. The caller sets its target and viewport.
    [[nodiscard]] filament::View& view() const { return *view_; }

private:
    filament::Engine& engine_;
    std::unique_ptr<DrawnPicture> picture_;
    filament::Scene* scene_;
    filament::View* view_;
    filament::Camera* camera_;
    filament::VertexBuffer* vertices_;
    filament::IndexBuffer* indices_;
    filament::MaterialInstance* instance_;
    utils::Entity triangle_;
    utils::Entity eye_;
};

} // namespace filasofia::visual
