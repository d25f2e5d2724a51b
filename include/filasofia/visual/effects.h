#pragma once

#include "filasofia/visual/color.h"

#include <array>
#include <optional>

namespace filasofia::visual {

/// Corners and folds are darker, because little light from all sides reaches them.
struct AmbientOcclusion {
    double radius = 0.012; ///< [m], in (0, 10], reach of the darkening around corners
    double strength = 1.0; ///< [-], in [0, 4]

    friend constexpr bool operator==(const AmbientOcclusion&, const AmbientOcclusion&) = default;
};

constexpr auto fields(const AmbientOcclusion*)
{
    using E = AmbientOcclusion;
    return describe("AmbientOcclusion", field("radius", &E::radius, "m", openClosed(0, 10), "reach of dark corners"),
                    field("strength", &E::strength, "-", closed(0, 4), "how dark they are"));
}

/// Highlights spill over their edges, as in every lens.
struct Bloom {
    double strength = 0.06; ///< [-], in [0, 1]
    /// Only light brighter than white spills; otherwise all light, as through a misted lens.
    bool onlyHighlights = true;

    friend constexpr bool operator==(const Bloom&, const Bloom&) = default;
};

constexpr auto fields(const Bloom*)
{
    return describe("Bloom",
                    field("strength", &Bloom::strength, "-", closed(0, 1), "fraction of the light that spills"),
                    field("onlyHighlights", &Bloom::onlyHighlights, "only what is brighter than white spills"));
}

/// Blurs what is nearer or farther than the camera's focusDistance, according to its aperture.
struct DepthOfField {
    double strength = 1.0; ///< [-], in [0, 10], factor on the blur that the aperture gives

    friend constexpr bool operator==(const DepthOfField&, const DepthOfField&) = default;
};

constexpr auto fields(const DepthOfField*)
{
    return describe("DepthOfField",
                    field("strength", &DepthOfField::strength, "-", closed(0, 10), "factor on the blur"));
}

/// Darkens the picture towards its corners.
struct Vignette {
    double midPoint = 0.55; ///< [-], in [0, 1], larger is nearer to the corners
    double feather = 0.45;  ///< [-], in [0, 1], softness

    friend constexpr bool operator==(const Vignette&, const Vignette&) = default;
};

constexpr auto fields(const Vignette*)
{
    return describe("Vignette", field("midPoint", &Vignette::midPoint, "-", closed(0, 1), "where it darkens"),
                    field("feather", &Vignette::feather, "-", closed(0, 1), "softness"));
}

/// Smoke or cloudy water: distant surfaces fade into its colour.
struct Fog {
    double density = 2.0;    ///< [1/m], in (0, 1e4]; after 1/density metres the fog makes up 63 % of the light
    double start = 0.0;      ///< [m], in [0, 1e6], distance from the camera at which it begins
    double opacity = 1.0;    ///< [-], in [0, 1], maximum
    double brightness = 1.0; ///< [-], in [0, 100], relative to the surroundings' intensity
    Color color = {0.75, 0.77, 0.80};

    friend constexpr bool operator==(const Fog&, const Fog&) = default;
};

constexpr auto fields(const Fog*)
{
    return describe("Fog",
                    field("density", &Fog::density, "1/m", openClosed(0, 1e4), "inverse of the visible distance"),
                    field("start", &Fog::start, "m", closed(0, 1e6), "distance at which it begins"),
                    field("opacity", &Fog::opacity, "-", closed(0, 1), "maximum"),
                    field("brightness", &Fog::brightness, "-", closed(0, 100), "relative to the surroundings"),
                    field("color", &Fog::color, "colour of the fog"));
}

/// The effect of an endoscope's optics: a round field that darkens and blurs towards its rim, and barrel distortion.
/// Lengths are relative to half the picture's smaller side. The round field never shows anything from outside the
/// picture.
struct EndoscopeOptics {
    double maskRadius = 0.97;   ///< [-], in (0, 2], radius of the round field; the rest is black
    double maskSoftness = 0.02; ///< [-], in [0, 0.5], width of its soft edge, inwards
    double distortion = 0.25;   ///< [-], in [0, 1], barrel distortion: how much larger the middle is than the rim
    double vignette = 0.45;     ///< [-], in [0, 1], darkness of the rim
    double rimBlur = 0.008;     ///< [-], in [0, 0.05], radius of the blur at the rim
    double mist = 0.0;          ///< [-], in [0, 1], how fogged its lens is: it blurs, and light veils the picture
    double smear = 0.0;         ///< [-], in [0, 1], share of its lens that is smeared, from its rim inwards
    Color smearColor = {0.55, 0.09, 0.05}; ///< of what it is smeared with

    friend constexpr bool operator==(const EndoscopeOptics&, const EndoscopeOptics&) = default;
};

constexpr auto fields(const EndoscopeOptics*)
{
    using E = EndoscopeOptics;
    return describe("EndoscopeOptics",
                    field("maskRadius", &E::maskRadius, "-", openClosed(0, 2), "radius of the round field"),
                    field("maskSoftness", &E::maskSoftness, "-", closed(0, 0.5), "width of its edge"),
                    field("distortion", &E::distortion, "-", closed(0, 1), "how much larger the middle is"),
                    field("vignette", &E::vignette, "-", closed(0, 1), "how dark the rim is"),
                    field("rimBlur", &E::rimBlur, "-", closed(0, 0.05), "radius of the blur at the rim"),
                    field("mist", &E::mist, "-", closed(0, 1), "how fogged the lens is"),
                    field("smear", &E::smear, "-", closed(0, 1), "share of the lens that is smeared"),
                    field("smearColor", &E::smearColor, "of what it is smeared with"));
}

enum class Antialiasing {
    None,
    Fxaa, ///< smooths edges in the finished picture; cheap
    Taa,  ///< accumulates samples over frames; best for a scene at rest; the picture depends on earlier frames
    Msaa, ///< four samples at every edge
};

constexpr std::array<std::string_view, 4> names(const Antialiasing*) { return {"none", "fxaa", "taa", "msaa"}; }

/// The effects on a view's picture; an empty option means off.
struct Effects {
    bool shadows = true; ///< shadows of the lights that cast them
    Antialiasing antialiasing = Antialiasing::Fxaa;
    std::optional<AmbientOcclusion> ambientOcclusion = {};
    std::optional<Bloom> bloom = {};
    std::optional<DepthOfField> depthOfField = {};
    std::optional<Vignette> vignette = {};
    std::optional<Fog> fog = {};
    std::optional<EndoscopeOptics> endoscope = {};

    friend constexpr bool operator==(const Effects&, const Effects&) = default;
};

constexpr auto fields(const Effects*)
{
    using E = Effects;
    return describe("Effects", field("shadows", &E::shadows, "whether bodies shade each other"),
                    field("antialiasing", &E::antialiasing, "how edges are smoothed"),
                    field("ambientOcclusion", &E::ambientOcclusion, "dark corners"),
                    field("bloom", &E::bloom, "highlights that spill"),
                    field("depthOfField", &E::depthOfField, "blur out of focus"),
                    field("vignette", &E::vignette, "dark corners of the picture"), field("fog", &E::fog, "smoke"),
                    field("endoscope", &E::endoscope, "endoscope optics"));
}

/// The effort for a view's picture.
enum class Quality {
    Low,    ///< no effects, no shadows; for fast tests
    Medium, ///< shadows, tone mapping, vignette, antialiasing
    High,   ///< as Medium, with ambient occlusion and bloom
};

constexpr std::array<std::string_view, 3> names(const Quality*) { return {"low", "medium", "high"}; }

/// The effects of a preset, as a starting point for others. `occlusionRadius` in [m].
Effects effectsOf(Quality quality, double occlusionRadius = AmbientOcclusion{}.radius);

} // namespace filasofia::visual
