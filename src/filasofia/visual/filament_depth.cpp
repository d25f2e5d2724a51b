#include "filasofia/visual/filament_depth.h"

#include "filasofia/visual/depth_views.h"
#include "filasofia/visual/filament_read.h"

#include <filament/Material.h>
#include <filament/Viewport.h>

namespace filasofia::visual {

DepthPass::DepthPass(filament::Engine& engine, MaterialPool& pool)
    : engine_(engine), pool_(pool), scene_(engine.createScene()), view_(engine.createView())
{
    view_->setScene(scene_);
    view_->setPostProcessingEnabled(false); // the values are numbers, not colours
    view_->setShadowingEnabled(false);
}

DepthPass::~DepthPass()
{
    engine_.destroy(view_);
    engine_.destroy(scene_);
    for (filament::MaterialInstance* each : unlabelled_)
        if (each) engine_.destroy(each);
}

void DepthPass::resize(int width, int height)
{
    if (values_ && values_->width() == width && values_->height() == height) return;
    values_ = std::make_unique<DrawnPicture>(engine_, width, height, DrawnPicture::Content::Numbers);
    view_->setRenderTarget(values_->target());
    view_->setViewport({0, 0, std::uint32_t(width), std::uint32_t(height)});
}

void DepthPass::begin(filament::Camera& camera, int width, int height)
{
    resize(width, height);
    view_->setCamera(&camera);
}

void DepthPass::wear(FilamentBody& body, filament::MaterialInstance& instance)
{
    body.wear(instance);
    scene_->addEntity(body.entity());
}

void DepthPass::end(const Bodies& bodies)
{
    for (const auto& [slot, body] : bodies) {
        if (!body->visible()) continue;
        scene_->remove(body->entity());
        body->wearOwn();
    }
}

filament::MaterialInstance& DepthPass::unlabelled(bool twoSided)
{
    filament::MaterialInstance*& instance = unlabelled_[twoSided ? 1 : 0];
    if (!instance) instance = pool_.get("depth").createInstance();
    return *instance;
}

DepthImage DepthPass::draw(filament::Renderer& renderer, filament::Camera& camera, const Bodies& bodies, int width,
                           int height)
{
    begin(camera, width, height);
    // Made for this picture only: a body that kept one would take one more of Filament's scarce handles.
    std::vector<filament::MaterialInstance*> worn;
    for (const auto& [slot, body] : bodies) {
        if (!body->visible()) continue;
        filament::MaterialInstance* instance = pool_.get("depth").createInstance();
        setParameter(*instance, "label", static_cast<float>(body->label()));
        wear(*body, *instance);
        worn.push_back(instance);
    }
    renderer.renderStandaloneView(view_);
    end(bodies);
    for (filament::MaterialInstance* each : worn) engine_.destroy(each);
    return read(renderer);
}

DepthImage DepthPass::read(filament::Renderer& renderer) const
{
    DepthImage out = emptyDepth(values_->width(), values_->height());
    std::vector<std::array<float, 2>> values(out.depth.size());
    readPixels(engine_, renderer, values_->target(), out.width, out.height, false,
               {values.data(), values.size() * sizeof(values[0]), filament::backend::PixelDataFormat::RG,
                filament::backend::PixelDataType::FLOAT});
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(values[i][0] > 0.0F)) continue; // nothing was drawn here
        out.depth[i] = values[i][0];
        out.label[i] = static_cast<std::uint32_t>(values[i][1]);
    }
    return out;
}

} // namespace filasofia::visual
