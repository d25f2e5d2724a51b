#pragma once

#include "filasofia/core/fields.h"

#include <variant>

namespace filasofia::visual {

/// Linear RGB (not sRGB).
struct Color {
    double red = 0.0;   ///< [-], in [0, 1]
    double green = 0.0; ///< [-], in [0, 1]
    double blue = 0.0;  ///< [-], in [0, 1]

    friend constexpr bool operator==(const Color&, const Color&) = default;
};

constexpr auto fields(const Color*)
{
    return describe("Color", field("red", &Color::red, "-", closed(0, 1), "linear red"),
                    field("green", &Color::green, "-", closed(0, 1), "linear green"),
                    field("blue", &Color::blue, "-", closed(0, 1), "linear blue"));
}

/// Living tissue: light enters, reddens and leaves elsewhere; a film of liquid glistens on top. The pattern (mottling,
/// vessels, fine relief) is bound to the rest position, so that it moves with the tissue.
struct TissueMaterial {
    Color baseColor = {0.58, 0.135, 0.115};       ///< colour of the lit surface
    Color subsurfaceColor = {0.70, 0.080, 0.055}; ///< colour of the light that has travelled inside
    Color vesselColor = {0.26, 0.008, 0.014};     ///< colour of the small vessels
    double roughness = 0.45;                      ///< [-], in [0.05, 1], of the tissue below the film
    double wetness = 0.8;                         ///< [-], in [0, 1], how much of the surface the film covers
    double thickness = 0.6;                       ///< [-], in [0, 1]: thin tissue lets more light through
    double noiseScale = 165.0;                    ///< [1/m], > 0: mottles per metre; relief and vessels follow it
    double mottling = 0.6;                        ///< [-], in [0, 1]
    double vessels = 0.6;                         ///< [-], in [0, 1]
    double bump = 0.5;                            ///< [-], in [0, 2], height of the fine relief

    friend constexpr bool operator==(const TissueMaterial&, const TissueMaterial&) = default;
};

constexpr auto fields(const TissueMaterial*)
{
    using M = TissueMaterial;
    return describe("TissueMaterial", field("baseColor", &M::baseColor, "colour of the lit surface"),
                    field("subsurfaceColor", &M::subsurfaceColor, "colour of light that has travelled inside"),
                    field("vesselColor", &M::vesselColor, "colour of the small vessels"),
                    field("roughness", &M::roughness, "-", closed(0.05, 1), "roughness below the film"),
                    field("wetness", &M::wetness, "-", closed(0, 1), "how much of the surface the film covers"),
                    field("thickness", &M::thickness, "-", closed(0, 1), "thin tissue lets more light through"),
                    field("noiseScale", &M::noiseScale, "1/m", positive(), "mottles per metre"),
                    field("mottling", &M::mottling, "-", closed(0, 1), "strength of the blotches"),
                    field("vessels", &M::vessels, "-", closed(0, 1), "strength of the small vessels"),
                    field("bump", &M::bump, "-", closed(0, 2), "height of the fine relief"));
}

/// Bare metal of instruments.
struct MetalMaterial {
    Color baseColor = {0.78, 0.79, 0.81}; ///< colour of the reflection
    double roughness = 0.3;               ///< [-], in [0.05, 1]

    friend constexpr bool operator==(const MetalMaterial&, const MetalMaterial&) = default;
};

constexpr auto fields(const MetalMaterial*)
{
    using M = MetalMaterial;
    return describe("MetalMaterial", field("baseColor", &M::baseColor, "colour of the reflection"),
                    field("roughness", &M::roughness, "-", closed(0.05, 1), "blur of the reflection"));
}

using Material = std::variant<TissueMaterial, MetalMaterial>;

} // namespace filasofia::visual
