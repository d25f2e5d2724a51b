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

    using Bodies = std::map<Slot, std::unique_ptr<FilamentBody>>;
    /// Draws what `camera` sees of the visible ones by `render(filament::View*)` into the picture, without labels.
    template <class Render>
    void drawDepth(Render&& render, filament::Camera& camera, const Bodies& bodies, int width, int height)
    {
        begin(camera, width, height);
        for (const auto& [slot, body] : bodies)
            if (body->visible()) wear(*body, unlabelled(body->twoSided()));
        render(view_);
        end(bodies);
    }
    /// The picture that drawDepth() draws into, made now.
    const DrawnPicture& prepare(int width, int height)
    {
        resize(width, height);
        return *values_;
    }
    /// What `camera` sees of the visible ones of `bodies`, outside of a frame of the renderer.
    DepthImage draw(filament::Renderer& renderer, filament::Camera& camera, const Bodies& bodies, int width,
                    int height);

private:
    void resize(int width, int height);
    void begin(filament::Camera& camera, int width, int height);
    void wear(FilamentBody& body, filament::MaterialInstance& instance);
    void end(const Bodies& bodies);
    /// An instance that bodies of one kind of culling share.
    filament::MaterialInstance& unlabelled(bool twoSided);
    [[nodiscard]] DepthImage read(filament::Renderer& renderer) const;

    filament::Engine& engine_;
    MaterialPool& pool_;
    filament::Scene* scene_;
    filament::View* view_;
    std::unique_ptr<DrawnPicture> values_; ///< depth [m] and label
    std::array<filament::MaterialInstance*, 2> unlabelled_ = {};
};

} // namespace filasofia::visual
