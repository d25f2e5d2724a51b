#include "filasofia/visual/material_pool.h"

#include "filasofia/core/error.h"

#include <math/vec2.h>
#include <math/vec3.h>
#include <math/vec4.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace filasofia::visual {
namespace embedded { // made by materials/embed.cmake
extern const std::uint8_t tissue[], metal[], mucosa[], bone[], glass[], unlit[], optics[], gui[], canvas[], debug[];
extern const std::size_t tissueSize, metalSize, mucosaSize, boneSize, glassSize, unlitSize, opticsSize, guiSize,
    canvasSize, debugSize;
} // namespace embedded

namespace {

using filament::math::float2;
using filament::math::float3;
using filament::math::float4;

struct Package {
    const char* name;
    const std::uint8_t* bytes;
    const std::size_t* size;
};
constexpr Package kPackages[] = {
    {"tissue", embedded::tissue, &embedded::tissueSize}, {"metal", embedded::metal, &embedded::metalSize},
    {"mucosa", embedded::mucosa, &embedded::mucosaSize}, {"bone", embedded::bone, &embedded::boneSize},
    {"glass", embedded::glass, &embedded::glassSize},    {"unlit", embedded::unlit, &embedded::unlitSize},
    {"optics", embedded::optics, &embedded::opticsSize}, {"gui", embedded::gui, &embedded::guiSize},
    {"canvas", embedded::canvas, &embedded::canvasSize}, {"debug", embedded::debug, &embedded::debugSize}};

constexpr int kNormalMap = 1, kRoughnessMap = 2, kOcclusionMap = 4; // as in materials/texture.glsl

float3 linear(const Color& color) { return {float(color.red), float(color.green), float(color.blue)}; }

void applyTo(filament::MaterialInstance& instance, const TissueMaterial& m)
{
    setParameter(instance, "baseColor", linear(m.baseColor));
    setParameter(instance, "subsurfaceColor", linear(m.subsurfaceColor));
    setParameter(instance, "vesselColor", linear(m.vesselColor));
    setParameter(instance, "roughness", float(m.roughness));
    setParameter(instance, "wetness", float(m.wetness));
    setParameter(instance, "thickness", float(m.thickness));
    setParameter(instance, "noiseScale", float(m.noiseScale));
    setParameter(instance, "mottling", float(m.mottling));
    setParameter(instance, "vessels", float(m.vessels));
    setParameter(instance, "bump", float(m.bump));
}

void applyTo(filament::MaterialInstance& instance, const MucosaMaterial& m)
{
    setParameter(instance, "baseColor", linear(m.baseColor));
    setParameter(instance, "subsurfaceColor", linear(m.subsurfaceColor));
    setParameter(instance, "vesselColor", linear(m.vesselColor));
    setParameter(instance, "roughness", float(m.roughness));
    setParameter(instance, "wetness", float(m.wetness));
    setParameter(instance, "thickness", float(m.thickness));
    setParameter(instance, "noiseScale", float(m.noiseScale));
    setParameter(instance, "pits", float(m.pits));
    setParameter(instance, "vessels", float(m.vessels));
    setParameter(instance, "bump", float(m.bump));
}

void applyTo(filament::MaterialInstance& instance, const BoneMaterial& m)
{
    setParameter(instance, "baseColor", linear(m.baseColor));
    setParameter(instance, "stainColor", linear(m.stainColor));
    setParameter(instance, "roughness", float(m.roughness));
    setParameter(instance, "wetness", float(m.wetness));
    setParameter(instance, "noiseScale", float(m.noiseScale));
    setParameter(instance, "pores", float(m.pores));
    setParameter(instance, "bump", float(m.bump));
}

void applyTo(filament::MaterialInstance& instance, const MetalMaterial& m)
{
    setParameter(instance, "baseColor", linear(m.baseColor));
    setParameter(instance, "roughness", float(m.roughness));
}

void applyTo(filament::MaterialInstance& instance, const GlassMaterial& m)
{
    // Beer and Lambert: tint is what is left after `thickness`.
    const double way = std::max(m.thickness, 1e-6);
    const auto absorption = [&](double share) { return float(-std::log(share) / way); };
    setParameter(instance, "absorption",
                 float3{absorption(m.tint.red), absorption(m.tint.green), absorption(m.tint.blue)});
    setParameter(instance, "roughness", float(m.roughness));
    setParameter(instance, "refractiveIndex", float(m.refractiveIndex));
    setParameter(instance, "thickness", float(way));
}

void applyTo(filament::MaterialInstance& instance, const UnlitMaterial& m)
{
    setParameter(instance, "color", linear(m.color));
}

/// Sets one parameter of the user's own material; its type has been checked. Textures are set elsewhere.
struct CustomSetter {
    filament::MaterialInstance& instance;
    const char* name;

    void operator()(double v) const { setParameter(instance, name, float(v)); }
    void operator()(int v) const { setParameter(instance, name, v); }
    void operator()(bool v) const { setParameter(instance, name, v); }
    void operator()(const Color& v) const { setParameter(instance, name, linear(v)); }
    void operator()(const Vec3& v) const { setParameter(instance, name, float3{float(v.x), float(v.y), float(v.z)}); }
    void operator()(const std::array<double, 4>& v) const
    {
        setParameter(instance, name, float4{float(v[0]), float(v[1]), float(v[2]), float(v[3])});
    }
    void operator()(const Texture&) const {}
};

/// 0, or white: what was set before must not stay.
void clear(filament::MaterialInstance& instance, const MaterialPackage& package)
{
    using Kind = MaterialPackage::Kind;
    for (const MaterialPackage::Parameter& each : package.parameters) {
        const char* name = each.name.c_str();
        if (each.name.starts_with('_')) continue; // the compiler's own
        if (each.kind == Kind::Float) setParameter(instance, name, 0.0F);
        if (each.kind == Kind::Float3) setParameter(instance, name, float3{});
        if (each.kind == Kind::Float4) setParameter(instance, name, float4{});
        if (each.kind == Kind::Int) setParameter(instance, name, 0);
        if (each.kind == Kind::Bool) setParameter(instance, name, false);
    }
}

} // namespace

template <class Value> void setParameter(filament::MaterialInstance& instance, const char* name, Value value)
{
    if (!instance.getMaterial()->hasParameter(name))
        fail("material '", instance.getMaterial()->getName(), "' has no parameter '", name, "'");
    instance.setParameter(name, value);
}
template void setParameter(filament::MaterialInstance&, const char*, float);
template void setParameter(filament::MaterialInstance&, const char*, float2);
template void setParameter(filament::MaterialInstance&, const char*, float3);

MaterialPool::~MaterialPool()
{
    for (const auto& [name, material] : loaded_) engine_.destroy(material);
}

filament::Material& MaterialPool::load(const std::string& name, const std::uint8_t* bytes, std::size_t size)
{
    filament::Material* material = filament::Material::Builder().package(bytes, size).build(engine_);
    if (!material) fail("material '", name, "' does not load");
    loaded_[name] = material;
    return *material;
}

filament::Material& MaterialPool::get(const std::string& name)
{
    const auto found = loaded_.find(name);
    if (found != loaded_.end()) return *found->second;
    for (const Package& package : kPackages)
        if (name == package.name) return load(name, package.bytes, *package.size);
    fail("there is no material '", name, "'");
}

filament::Material& MaterialPool::get(const CustomMaterial& material, const MaterialPackage& package)
{
    const auto found = loaded_.find(nameOf(material));
    if (found != loaded_.end()) return *found->second;
    return load(nameOf(material), package.bytes.data(), package.bytes.size());
}

filament::MaterialInstance* MaterialPool::instance(const ReadyMaterial& material)
{
    const auto* custom = std::get_if<CustomMaterial>(&material.material);
    filament::Material& loaded = custom ? get(*custom, *material.package) : get(nameOf(material.material));
    filament::MaterialInstance* made = loaded.createInstance();
    apply(material, *made);
    return made;
}

void MaterialPool::apply(const ReadyMaterial& material, filament::MaterialInstance& instance)
{
    std::visit(
        [&](const auto& held) {
            using Held = std::remove_cvref_t<decltype(held)>;
            if constexpr (std::is_same_v<Held, CustomMaterial>) {
                clear(instance, *material.package);
                for (const MaterialPackage::Parameter& each : material.package->parameters)
                    if (each.kind == MaterialPackage::Kind::Sampler)
                        textures_.apply(NoTexture{}, material, instance, each.name.c_str());
                for (const MaterialParameter& each : held.parameters) {
                    std::visit(CustomSetter{instance, each.name.c_str()}, each.value);
                    if (const auto* texture = std::get_if<Texture>(&each.value))
                        textures_.apply(*texture, material, instance, each.name.c_str());
                }
            } else if constexpr (!std::is_same_v<Held, NamedMaterial>) {
                applyTo(instance, held);
                applyTextures(held, material, instance);
            }
        },
        material.material);
}

template <class Held>
void MaterialPool::applyTextures(const Held& held, const ReadyMaterial& from, filament::MaterialInstance& instance)
{
    if constexpr (requires { held.baseColorTexture; })
        textures_.applyWithKind(held.baseColorTexture, from, instance, "baseColorTexture");
    if constexpr (requires { held.texture; }) textures_.applyWithKind(held.texture, from, instance, "picture");
    if constexpr (requires { held.normalTexture; }) { // all but UnlitMaterial
        const auto given = [](const TextureMap& map) { return std::holds_alternative<TextureFile>(map); };
        textures_.applyMap(held.normalTexture, from, instance, "normalTexture");
        textures_.applyMap(held.roughnessTexture, from, instance, "roughnessTexture");
        int maps = (given(held.normalTexture) ? kNormalMap : 0) | (given(held.roughnessTexture) ? kRoughnessMap : 0);
        setParameter(instance, "normalStrength", float(held.normalStrength));
        if constexpr (requires { held.occlusionTexture; }) {
            textures_.applyMap(held.occlusionTexture, from, instance, "occlusionTexture");
            setParameter(instance, "occlusionStrength", float(held.occlusionStrength));
            maps |= given(held.occlusionTexture) ? kOcclusionMap : 0;
        }
        setParameter(instance, "maps", maps);
    }
}

std::string MaterialPool::nameOf(const Material& material)
{
    struct Visitor {
        std::string operator()(const TissueMaterial&) const { return "tissue"; }
        std::string operator()(const MetalMaterial&) const { return "metal"; }
        std::string operator()(const MucosaMaterial&) const { return "mucosa"; }
        std::string operator()(const BoneMaterial&) const { return "bone"; }
        std::string operator()(const GlassMaterial&) const { return "glass"; }
        std::string operator()(const UnlitMaterial&) const { return "unlit"; }
        std::string operator()(const CustomMaterial& m) const { return "file " + m.file; }
        std::string operator()(const NamedMaterial&) const { fail("a material's name is no material"); }
    };
    return std::visit(Visitor{}, material);
}

} // namespace filasofia::visual
