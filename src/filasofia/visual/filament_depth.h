#pragma once

#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/filament_body.h"

#include <filament/Camera.h>
#include <filament/RenderTarget.h>
#include <filament/Renderer.h>
#include <filament/View.h>

#include <map>

namespace filasofia::visual {

/// Draws how far away bodies are and what they are, in place of what they look like.
class DepthPass {
public:
    DepthPass(filament::Engine& engine, MaterialPool& pool);
    DepthPass(const DepthPass&) = delete;
    DepthPass& operator=(const DepthPass&) = delete;
    ~DepthPass();

    /// What `camera` sees of the visible ones of `bodies`, outside of a frame of the renderer.
    DepthImage draw(filament::Renderer& renderer, filament::Camera& camera,
                    const std::map<Slot, std::unique_ptr<FilamentBody>>& bodies, int width, int height);

private:
    void resize(int width, int height);
    void destroyTarget();
    [[nodiscard]] DepthImage read(filament::Renderer& renderer) const;

    filament::Engine& engine_;
    MaterialPool& pool_;
    filament::Scene* scene_;
    filament::View* view_;
    int width_ = 0;
    int height_ = 0;
    filament::Texture* values_ = nullptr; ///< depth [m] and label
    filament::Texture* nearest_ = nullptr;
    filament::RenderTarget* target_ = nullptr;
};

} // namespace filasofia::visual
