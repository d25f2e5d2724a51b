#include "filasofia/visual/effects.h"

namespace filasofia::visual {

Effects effectsOf(Quality quality, double occlusionRadius)
{
    Effects effects;
    if (quality == Quality::Low) {
        effects.shadows = false;
        effects.antialiasing = Antialiasing::None;
        return effects;
    }
    effects.vignette = Vignette{};
    if (quality == Quality::Medium) return effects;
    effects.ambientOcclusion = AmbientOcclusion{.radius = occlusionRadius};
    effects.bloom = Bloom{};
    return effects;
}

} // namespace filasofia::visual
