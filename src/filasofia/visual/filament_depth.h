#pragma once

#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/filament_body.h"
#include "filasofia/visual/filament_optics.h"

#include <filament/Camera.h>
#include <filament/Renderer.h>
#include <filament/View.h>

#include <map>
#include <memory>

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
    [[nodiscard]] DepthImage read(filament::Renderer& renderer) const;

    filament::Engine& engine_;
    MaterialPool& pool_;
    filament::Scene* scene_;
    filament::View* view_;
    std::unique_ptr<DrawnPicture> values_; ///< depth [m] and label
};

} // namespace filasofia::visual
