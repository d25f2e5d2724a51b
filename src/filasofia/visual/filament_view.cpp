#include "filasofia/visual/filament_view.h"

#include "filasofia/visual/pixel_area.h"

namespace filasofia::visual {

void applyQuality(filament::View& view, Quality quality, double occlusionRadius)
{
    using FView = filament::View;
    const bool some = quality != Quality::Low, all = quality == Quality::High;
    view.setPostProcessingEnabled(true); // also at Low: tone mapping and sRGB are part of it
    view.setShadowingEnabled(some);
    view.setAntiAliasing(some ? FView::AntiAliasing::FXAA : FView::AntiAliasing::NONE);
    view.setDithering(FView::Dithering::NONE); // it changes with time, and the same scene must give the same picture

    FView::AmbientOcclusionOptions occlusion;
    occlusion.enabled = all;
    occlusion.radius = static_cast<float>(occlusionRadius);
    occlusion.bias = static_cast<float>(0.02 * occlusionRadius);
    occlusion.power = 1.4F;
    occlusion.quality = FView::QualityLevel::MEDIUM;
    occlusion.upsampling = FView::QualityLevel::HIGH;
    view.setAmbientOcclusionOptions(occlusion);

    FView::BloomOptions bloom;
    bloom.enabled = all;
    bloom.strength = 0.06F;
    view.setBloomOptions(bloom);

    FView::VignetteOptions vignette;
    vignette.enabled = some;
    vignette.midPoint = 0.55F;
    vignette.roundness = 1.0F;
    vignette.feather = 0.45F;
    view.setVignetteOptions(vignette);
}

filament::Viewport pixelsOf(const Viewport& port, int windowWidth, int windowHeight)
{
    const PixelArea area = pixelArea(port, windowWidth, windowHeight);
    return {area.left, windowHeight - area.bottom, std::uint32_t(area.width()), std::uint32_t(area.height())};
}

} // namespace filasofia::visual
