#include "filasofia/visual/filament_view.h"

#include "filasofia/visual/pixel_area.h"

#include <filament/Camera.h>

#include <algorithm>
#include <cmath>

namespace filasofia::visual {

void applyEffects(filament::View& view, const Effects& effects, double blurScale)
{
    using FView = filament::View;
    view.setPostProcessingEnabled(true); // even without effects, because it includes tone mapping and sRGB
    view.setShadowingEnabled(effects.shadows);
    view.setDithering(
        FView::Dithering::NONE); // dithering changes with time, but the same scene must give the same picture

    const Antialiasing smooth = effects.antialiasing;
    view.setAntiAliasing(smooth == Antialiasing::Fxaa ? FView::AntiAliasing::FXAA : FView::AntiAliasing::NONE);
    view.setSampleCount(smooth == Antialiasing::Msaa ? 4 : 1);
    FView::TemporalAntiAliasingOptions temporal;
    temporal.enabled = smooth == Antialiasing::Taa;
    view.setTemporalAntiAliasingOptions(temporal);

    FView::AmbientOcclusionOptions occlusion;
    const AmbientOcclusion asked = effects.ambientOcclusion.value_or(AmbientOcclusion{});
    occlusion.enabled = effects.ambientOcclusion.has_value();
    occlusion.radius = static_cast<float>(asked.radius);
    occlusion.bias = static_cast<float>(0.02 * asked.radius);
    occlusion.intensity = static_cast<float>(asked.strength);
    occlusion.power = 1.4F;
    occlusion.quality = FView::QualityLevel::MEDIUM;
    occlusion.upsampling = FView::QualityLevel::HIGH;
    view.setAmbientOcclusionOptions(occlusion);

    FView::BloomOptions bloom;
    bloom.enabled = effects.bloom.has_value();
    const Bloom spill = effects.bloom.value_or(Bloom{});
    bloom.strength = static_cast<float>(spill.strength);
    bloom.threshold = spill.onlyHighlights;
    bloom.blendMode =
        spill.onlyHighlights ? FView::BloomOptions::BlendMode::ADD : FView::BloomOptions::BlendMode::INTERPOLATE;
    view.setBloomOptions(bloom);

    FView::DepthOfFieldOptions focus;
    focus.enabled = effects.depthOfField.has_value();
    focus.nativeResolution = true; // at half the resolution small pictures show blocks
    focus.cocScale = static_cast<float>(blurScale * effects.depthOfField.value_or(DepthOfField{}).strength);
    view.setDepthOfFieldOptions(focus);

    FView::VignetteOptions vignette;
    vignette.enabled = effects.vignette.has_value();
    vignette.midPoint = static_cast<float>(effects.vignette.value_or(Vignette{}).midPoint);
    vignette.roundness = 1.0F;
    vignette.feather = static_cast<float>(effects.vignette.value_or(Vignette{}).feather);
    view.setVignetteOptions(vignette);

    const Fog smoke = effects.fog.value_or(Fog{});
    const auto light = [&](double share) { return static_cast<float>(share * smoke.brightness); };
    FView::FogOptions fog;
    fog.enabled = effects.fog.has_value();
    fog.density = static_cast<float>(smoke.density);
    fog.distance = static_cast<float>(smoke.start);
    fog.maximumOpacity = static_cast<float>(smoke.opacity);
    fog.heightFalloff = 0.0F; // the same density at every height
    fog.color = {light(smoke.color.red), light(smoke.color.green), light(smoke.color.blue)};
    view.setFogOptions(fog);
}

double exposeCamera(filament::Camera& camera, const CameraDef& def)
{
    // The library clamps f-number, shutter and sensitivity to those of real cameras. Changing one of the three gives
    // any exposure in [-10, 25] within its limits: EV = log2(N^2 / t * 100 / S). (In 1.9.25 setExposure(float) inverts
    // its number.)
    double fNumber = 1.0, sensitivity = 100.0;
    if (def.exposure > 14.0) fNumber = 64.0;
    if (def.exposure < -5.0) sensitivity = 204800.0;
    const double shutter = fNumber * fNumber * 100.0 / sensitivity * std::exp2(-def.exposure);
    camera.setExposure(float(fNumber), float(shutter), float(sensitivity));
    camera.setFocusDistance(static_cast<float>(def.focusDistance));
    return fNumber / def.aperture;
}

filament::Viewport pixelsOf(const Viewport& port, int windowWidth, int windowHeight)
{
    const PixelArea area = pixelArea(port, windowWidth, windowHeight);
    return {area.left, windowHeight - area.bottom, std::uint32_t(area.width()), std::uint32_t(area.height())};
}

} // namespace filasofia::visual
