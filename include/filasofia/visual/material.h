#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/visual/custom_material.h"
#include "filasofia/visual/texture.h"

#include <variant>

namespace filasofia::visual {

// addedFields() counts the last fields of a struct that are younger than the first recordings. A recording leaves them
// out while they have their defaults.

/// describe() for a material with textures: its own fields, then those of the textures, which all such materials share.
template <class M, class... Own> constexpr auto describeWithTextures(std::string_view typeName, Own... own)
{
    return describe(
        typeName, own..., field("baseColorTexture", &M::baseColorTexture, "in place of baseColor"),
        field("normalTexture", &M::normalTexture, "slopes of the surface, a normal map"),
        field("roughnessTexture", &M::roughnessTexture, "green channel in place of roughness"),
        field("occlusionTexture", &M::occlusionTexture, "red channel: light that gets into crevices"),
        field("normalStrength", &M::normalStrength, "-", closed(0, 4), "multiplies the normal map's slopes"),
        field("occlusionStrength", &M::occlusionStrength, "-", closed(0, 1), "0 ignores occlusionTexture"));
}

/// Living tissue: light enters, reddens and leaves elsewhere; a film of liquid glistens on top. The pattern (mottling,
/// vessels, fine relief) is fixed to the rest position, so that it moves with the tissue.
struct TissueMaterial {
    Color baseColor = {0.58, 0.135, 0.115};       ///< colour of the lit surface
    Color subsurfaceColor = {0.70, 0.080, 0.055}; ///< colour of the light that has travelled inside
    Color vesselColor = {0.26, 0.008, 0.014};     ///< colour of the small vessels
    double roughness = 0.45;                      ///< [-], in [0.05, 1], of the tissue below the film
    double wetness = 0.8;                         ///< [-], in [0, 1], fraction of the surface that the film covers
    double thickness = 0.6;                       ///< [-], in [0, 1]; thin tissue lets more light through
    double noiseScale = 165.0;                    ///< [1/m], > 0, blotches per metre; relief and vessels scale with it
    double mottling = 0.6;                        ///< [-], in [0, 1]
    double vessels = 0.6;                         ///< [-], in [0, 1]
    double bump = 0.5;                            ///< [-], in [0, 2], height of the fine relief
    Texture baseColorTexture = {};                ///< in place of baseColor
    TextureMap normalTexture = {};                ///< tangent-space normal map, added to the relief
    TextureMap roughnessTexture = {};             ///< green channel: in place of roughness
    TextureMap occlusionTexture = {};             ///< red channel: share of light that reaches a crevice
    double normalStrength = 1.0;                  ///< [-], in [0, 4]: multiplies the slopes of normalTexture
    double occlusionStrength = 1.0;               ///< [-], in [0, 1]: 0 ignores occlusionTexture

    friend bool operator==(const TissueMaterial&, const TissueMaterial&) = default;
};

constexpr auto fields(const TissueMaterial*)
{
    using M = TissueMaterial;
    return describeWithTextures<M>(
        "TissueMaterial", field("baseColor", &M::baseColor, "colour of the lit surface"),
        field("subsurfaceColor", &M::subsurfaceColor, "colour of light that has travelled inside"),
        field("vesselColor", &M::vesselColor, "colour of the small vessels"),
        field("roughness", &M::roughness, "-", closed(0.05, 1), "roughness below the film"),
        field("wetness", &M::wetness, "-", closed(0, 1), "fraction of the surface that the film covers"),
        field("thickness", &M::thickness, "-", closed(0, 1), "thin tissue lets more light through"),
        field("noiseScale", &M::noiseScale, "1/m", positive(), "blotches per metre"),
        field("mottling", &M::mottling, "-", closed(0, 1), "strength of the blotches"),
        field("vessels", &M::vessels, "-", closed(0, 1), "strength of the small vessels"),
        field("bump", &M::bump, "-", closed(0, 2), "height of the fine relief"));
}
constexpr std::size_t addedFields(const TissueMaterial*) { return 5; }

/// The lining of hollow organs: paler and wetter than tissue, with the pits of its glands and a fine net of vessels
/// under a film of mucus.
struct MucosaMaterial {
    Color baseColor = {0.66, 0.235, 0.190};      ///< colour of the lit surface
    Color subsurfaceColor = {0.64, 0.11, 0.085}; ///< colour of the light that has travelled inside
    Color vesselColor = {0.30, 0.012, 0.016};    ///< colour of the small vessels
    double roughness = 0.40;                     ///< [-], in [0.05, 1], of the lining below the film
    double wetness = 0.95;                       ///< [-], in [0, 1], fraction of the surface that the film covers
    double thickness = 0.45;                     ///< [-], in [0, 1]; a thin lining lets more light through
    double noiseScale = 165.0;                   ///< [1/m], > 0, blotches per metre; pits and vessels scale with it
    double pits = 0.6;                           ///< [-], in [0, 1], strength of the pattern of pits
    double vessels = 0.6;                        ///< [-], in [0, 1]
    double bump = 0.5;                           ///< [-], in [0, 2], height of the fine relief
    Texture baseColorTexture = {};               ///< in place of baseColor
    TextureMap normalTexture = {};               ///< tangent-space normal map, added to the relief
    TextureMap roughnessTexture = {};            ///< green channel: in place of roughness
    TextureMap occlusionTexture = {};            ///< red channel: share of light that reaches a crevice
    double normalStrength = 1.0;                 ///< [-], in [0, 4]: multiplies the slopes of normalTexture
    double occlusionStrength = 1.0;              ///< [-], in [0, 1]: 0 ignores occlusionTexture

    friend bool operator==(const MucosaMaterial&, const MucosaMaterial&) = default;
};

constexpr auto fields(const MucosaMaterial*)
{
    using M = MucosaMaterial;
    return describeWithTextures<M>(
        "MucosaMaterial", field("baseColor", &M::baseColor, "colour of the lit surface"),
        field("subsurfaceColor", &M::subsurfaceColor, "colour of light that has travelled inside"),
        field("vesselColor", &M::vesselColor, "colour of the small vessels"),
        field("roughness", &M::roughness, "-", closed(0.05, 1), "roughness below the film"),
        field("wetness", &M::wetness, "-", closed(0, 1), "fraction of the surface that the film covers"),
        field("thickness", &M::thickness, "-", closed(0, 1), "a thin lining lets more light through"),
        field("noiseScale", &M::noiseScale, "1/m", positive(), "blotches per metre"),
        field("pits", &M::pits, "-", closed(0, 1), "strength of the pattern of pits"),
        field("vessels", &M::vessels, "-", closed(0, 1), "strength of the small vessels"),
        field("bump", &M::bump, "-", closed(0, 2), "height of the fine relief"));
}
constexpr std::size_t addedFields(const MucosaMaterial*) { return 5; }

/// Living bone, ivory and slightly moist: fine grain along one direction, pores, and stains where vessels enter.
struct BoneMaterial {
    Color baseColor = {0.76, 0.63, 0.44};  ///< colour of the lit surface
    Color stainColor = {0.48, 0.20, 0.11}; ///< colour in pores and stains
    double roughness = 0.5;                ///< [-], in [0.05, 1]
    double wetness = 0.55;                 ///< [-], in [0, 1], fraction of the surface that is moist
    double noiseScale = 165.0;             ///< [1/m], > 0, blotches per metre; grain and pores scale with it
    double pores = 0.65;                   ///< [-], in [0, 1]
    double bump = 0.5;                     ///< [-], in [0, 2], height of the fine relief
    Texture baseColorTexture = {};         ///< in place of baseColor
    TextureMap normalTexture = {};         ///< tangent-space normal map, added to the relief
    TextureMap roughnessTexture = {};      ///< green channel: in place of roughness
    TextureMap occlusionTexture = {};      ///< red channel: share of light that reaches a crevice
    double normalStrength = 1.0;           ///< [-], in [0, 4]: multiplies the slopes of normalTexture
    double occlusionStrength = 1.0;        ///< [-], in [0, 1]: 0 ignores occlusionTexture

    friend bool operator==(const BoneMaterial&, const BoneMaterial&) = default;
};

constexpr auto fields(const BoneMaterial*)
{
    using M = BoneMaterial;
    return describeWithTextures<M>(
        "BoneMaterial", field("baseColor", &M::baseColor, "colour of the lit surface"),
        field("stainColor", &M::stainColor, "colour in pores and stains"),
        field("roughness", &M::roughness, "-", closed(0.05, 1), "roughness where it is dry"),
        field("wetness", &M::wetness, "-", closed(0, 1), "fraction of the surface that is moist"),
        field("noiseScale", &M::noiseScale, "1/m", positive(), "blotches per metre"),
        field("pores", &M::pores, "-", closed(0, 1), "strength of pores and stains"),
        field("bump", &M::bump, "-", closed(0, 2), "height of the fine relief"));
}
constexpr std::size_t addedFields(const BoneMaterial*) { return 5; }

/// Bare metal of instruments.
struct MetalMaterial {
    Color baseColor = {0.78, 0.79, 0.81}; ///< colour of the reflection
    double roughness = 0.3;               ///< [-], in [0.05, 1]
    Texture baseColorTexture = {};        ///< in place of baseColor
    TextureMap normalTexture = {};        ///< tangent-space normal map
    TextureMap roughnessTexture = {};     ///< green channel: in place of roughness
    TextureMap occlusionTexture = {};     ///< red channel: share of light that reaches a crevice
    double normalStrength = 1.0;          ///< [-], in [0, 4]: multiplies the slopes of normalTexture
    double occlusionStrength = 1.0;       ///< [-], in [0, 1]: 0 ignores occlusionTexture

    friend bool operator==(const MetalMaterial&, const MetalMaterial&) = default;
};

constexpr auto fields(const MetalMaterial*)
{
    using M = MetalMaterial;
    return describeWithTextures<M>("MetalMaterial", field("baseColor", &M::baseColor, "colour of the reflection"),
                                   field("roughness", &M::roughness, "-", closed(0.05, 1), "blur of the reflection"));
}
constexpr std::size_t addedFields(const MetalMaterial*) { return 5; }

/// Clear glass or plastic. It refracts what lies behind, except other glass, and reflects at its edges.
struct GlassMaterial {
    Color tint = {0.93, 0.97, 0.96};  ///< fraction of light transmitted through `thickness`; each > 0
    double roughness = 0.05;          ///< [-], in [0, 1]: blur of what lies behind
    double refractiveIndex = 1.5;     ///< [-], in [1, 2.5]
    double thickness = 0.004;         ///< [m], in [0, 1]: how far light travels inside
    TextureMap normalTexture = {};    ///< tangent-space normal map
    TextureMap roughnessTexture = {}; ///< green channel: in place of roughness
    double normalStrength = 1.0;      ///< [-], in [0, 4]: multiplies the slopes of normalTexture

    friend bool operator==(const GlassMaterial&, const GlassMaterial&) = default;
};

constexpr auto fields(const GlassMaterial*)
{
    using M = GlassMaterial;
    return describe(
        "GlassMaterial", field("tint", &M::tint, "fraction of transmitted light"),
        field("roughness", &M::roughness, "-", closed(0, 1), "blur of what lies behind"),
        field("refractiveIndex", &M::refractiveIndex, "-", closed(1, 2.5), "how much it bends light"),
        field("thickness", &M::thickness, "m", closed(0, 1), "how far light travels inside"),
        field("normalTexture", &M::normalTexture, "slopes of the surface, a normal map"),
        field("roughnessTexture", &M::roughnessTexture, "green channel in place of roughness"),
        field("normalStrength", &M::normalStrength, "-", closed(0, 4), "multiplies the normal map's slopes"));
}
constexpr std::size_t addedFields(const GlassMaterial*) { return 3; }

/// A thread: a braid of strands that run around it to both sides, or smooth. The pattern is fixed to a rod's material,
/// so it shows how the rod turns and twists. Only for rods: other bodies have no line along which the strands run.
struct ThreadMaterial {
    Color baseColor = {0.16, 0.07, 0.42}; ///< colour of the strands
    double roughness = 0.4;               ///< [-], in [0.05, 1]
    int strands = 6;                      ///< [-], in [0, 32], of the braid to each side; 0: a monofilament
    double pitch = 1e-3;                  ///< [m], > 0: along the thread while a strand goes around it once
    double relief = 1.0;                  ///< [-], in [0, 2], height of the strands

    friend bool operator==(const ThreadMaterial&, const ThreadMaterial&) = default;
};

constexpr auto fields(const ThreadMaterial*)
{
    using M = ThreadMaterial;
    return describe("ThreadMaterial", field("baseColor", &M::baseColor, "colour of the strands"),
                    field("roughness", &M::roughness, "-", closed(0.05, 1), "roughness of a strand"),
                    field("strands", &M::strands, "-", closed(0, 32), "of the braid to each side; 0: a monofilament"),
                    field("pitch", &M::pitch, "m", positive(), "along the thread while a strand goes around it once"),
                    field("relief", &M::relief, "-", closed(0, 2), "height of the strands"));
}

/// A surface with its own colour, whatever the light: markers, screens, labels. The picture shows exactly this colour.
struct UnlitMaterial {
    Color color = {1.0, 1.0, 1.0}; ///< the colour, or the factor on the texture
    Texture texture = {};

    friend bool operator==(const UnlitMaterial&, const UnlitMaterial&) = default;
};

constexpr auto fields(const UnlitMaterial*)
{
    return describe("UnlitMaterial", field("color", &UnlitMaterial::color, "colour, or the texture's factor"),
                    field("texture", &UnlitMaterial::texture, "texture"));
}

/// The material of this name in the server's pool (VisualServer::addMaterial), and what it becomes there. A body can
/// override parameters of it; the pool's material and other bodies keep theirs.
///
///     NamedMaterial{"liver", {{"roughness", 0.2}, {"baseColor", Color{0.4, 0.1, 0.08}}}}
struct NamedMaterial {
    std::string name = {};
    /// By the names of the fields, or of a CustomMaterial's parameters; each name at most once. The value has the type
    /// of the field; Texture{NoTexture{}} removes a texture.
    std::vector<MaterialParameter> overrides = {};

    friend bool operator==(const NamedMaterial&, const NamedMaterial&) = default;
};

constexpr auto fields(const NamedMaterial*)
{
    return describe("NamedMaterial", field("name", &NamedMaterial::name, "of a material in the server's pool"),
                    field("overrides", &NamedMaterial::overrides, "a body's own values of its parameters"));
}
constexpr std::size_t addedFields(const NamedMaterial*) { return 1; }

/// A surface of one colour without any pattern, as plastic and paint are.
inline TissueMaterial plainMaterial(Color color)
{
    return {.baseColor = color,
            .subsurfaceColor = color,
            .vesselColor = color,
            .roughness = 0.5,
            .wetness = 0.1,
            .thickness = 0.0,
            .mottling = 0.0,
            .vessels = 0.0,
            .bump = 0.0};
}

using Material = std::variant<TissueMaterial, MetalMaterial, MucosaMaterial, BoneMaterial, GlassMaterial, UnlitMaterial,
                              CustomMaterial, NamedMaterial, ThreadMaterial>;

} // namespace filasofia::visual
