#pragma once

#include "filasofia/visual/color.h"

#include <array>
#include <optional>

namespace filasofia::visual {

/// Corners and folds are darker: light from all sides hardly gets there.
struct AmbientOcclusion {
    double radius = 0.012; ///< [m], in (0, 10]: how far corners darken their surroundings
    double strength = 1.0; ///< [-], in [0, 4]

    friend constexpr bool operator==(const AmbientOcclusion&, const AmbientOcclusion&) = default;
};

constexpr auto fields(const AmbientOcclusion*)
{
    using E = AmbientOcclusion;
    return describe("AmbientOcclusion", field("radius", &E::radius, "m", openClosed(0, 10), "reach of dark corners"),
                    field("strength", &E::strength, "-", closed(0, 4), "how dark they are"));
}

/// Highlights spill over their edge, as in every lens.
struct Bloom {
    double strength = 0.06;     ///< [-], in [0, 1]
    bool onlyHighlights = true; ///< only what is brighter than white spills; else all light, as through a misted lens

    friend constexpr bool operator==(const Bloom&, const Bloom&) = default;
};

constexpr auto fields(const Bloom*)
{
    return describe("Bloom", field("strength", &Bloom::strength, "-", closed(0, 1), "share of the light that spills"),
                    field("onlyHighlights", &Bloom::onlyHighlights, "only what is brighter than white spills"));
}

/// What is nearer or farther than the camera's focusDistance is blurred, as its aperture says.
struct DepthOfField {
    double strength = 1.0; ///< [-], in [0, 10], times the blur that the aperture gives

    friend constexpr bool operator==(const DepthOfField&, const DepthOfField&) = default;
};

constexpr auto fields(const DepthOfField*)
{
    return describe("DepthOfField", field("strength", &DepthOfField::strength, "-", closed(0, 10), "times the blur"));
}

/// The picture darkens towards its corners.
struct Vignette {
    double midPoint = 0.55; ///< [-], in [0, 1]: larger is nearer to the corners
    double feather = 0.45;  ///< [-], in [0, 1], softness

    friend constexpr bool operator==(const Vignette&, const Vignette&) = default;
};

constexpr auto fields(const Vignette*)
{
    return describe("Vignette", field("midPoint", &Vignette::midPoint, "-", closed(0, 1), "where it darkens"),
                    field("feather", &Vignette::feather, "-", closed(0, 1), "softness"));
}

/// Smoke or cloudy water: what is farther away fades into its colour.
struct Fog {
    double density = 2.0;    ///< [1/m], in (0, 1e4]: after 1/density metres, 63 % are fog
    double start = 0.0;      ///< [m], in [0, 1e6], from the camera: no fog before
    double opacity = 1.0;    ///< [-], in [0, 1], at most
    double brightness = 1.0; ///< [-], in [0, 100], relative to the surroundings' intensity
    Color color = {0.75, 0.77, 0.80};

    friend constexpr bool operator==(const Fog&, const Fog&) = default;
};

constexpr auto fields(const Fog*)
{
    return describe("Fog", field("density", &Fog::density, "1/m", openClosed(0, 1e4), "inverse of how far one sees"),
                    field("start", &Fog::start, "m", closed(0, 1e6), "no fog before"),
                    field("opacity", &Fog::opacity, "-", closed(0, 1), "at most"),
                    field("brightness", &Fog::brightness, "-", closed(0, 100), "relative to the surroundings"),
                    field("color", &Fog::color, "colour of the fog"));
}

/// What an endoscope's optics do to the picture: a round field that darkens and blurs towards its rim, and straight
/// lines that bend outwards. Lengths are shares of half the picture's smaller side. What lies in the round field is
/// never from outside the picture.
struct EndoscopeOptics {
    double maskRadius = 0.97;   ///< [-], in (0, 2], of the round field; all else is black
    double maskSoftness = 0.02; ///< [-], in [0, 0.5], width of its edge, inwards
    double distortion = 0.25;   ///< [-], in [0, 1], barrel: how much the middle is larger than the rim
    double vignette = 0.45;     ///< [-], in [0, 1]: how dark the rim is
    double rimBlur = 0.008;     ///< [-], in [0, 0.05], radius of the blur at the rim

    friend constexpr bool operator==(const EndoscopeOptics&, const EndoscopeOptics&) = default;
};

constexpr auto fields(const EndoscopeOptics*)
{
    using E = EndoscopeOptics;
    return describe("EndoscopeOptics", field("maskRadius", &E::maskRadius, "-", openClosed(0, 2), "of the round field"),
                    field("maskSoftness", &E::maskSoftness, "-", closed(0, 0.5), "width of its edge"),
                    field("distortion", &E::distortion, "-", closed(0, 1), "how much the middle is larger"),
                    field("vignette", &E::vignette, "-", closed(0, 1), "how dark the rim is"),
                    field("rimBlur", &E::rimBlur, "-", closed(0, 0.05), "radius of the blur at the rim"));
}

enum class Antialiasing {
    None,
    Fxaa, ///< smooths edges in the finished picture: cheap
    Taa,  ///< gathers samples over frames: best at rest; the picture depends on the frames before
    Msaa, ///< four samples at every edge
};

constexpr std::array<std::string_view, 4> names(const Antialiasing*) { return {"none", "fxaa", "taa", "msaa"}; }

/// What is done to a view's picture; none means off.
struct Effects {
    bool shadows = true; ///< of the lights that cast some
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

/// What a view spends on its picture.
enum class Quality {
    Low,    ///< no effects, no shadows: fast tests
    Medium, ///< shadows, tone mapping, vignette, smoothed edges
    High,   ///< and ambient occlusion, bloom
};

constexpr std::array<std::string_view, 3> names(const Quality*) { return {"low", "medium", "high"}; }

/// The effects of a preset, as a start for one's own. `occlusionRadius` in [m].
Effects effectsOf(Quality quality, double occlusionRadius = AmbientOcclusion{}.radius);

} // namespace filasofia::visual
