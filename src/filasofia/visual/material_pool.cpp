#include "filasofia/visual/material_pool.h"

#include "filasofia/core/error.h"

#include <math/vec3.h>

#include <cstdint>

namespace filasofia::visual {
namespace embedded { // made by materials/embed.cmake
extern const std::uint8_t tissue[];
extern const std::size_t tissueSize;
extern const std::uint8_t metal[];
extern const std::size_t metalSize;
extern const std::uint8_t gui[];
extern const std::size_t guiSize;
extern const std::uint8_t canvas[];
extern const std::size_t canvasSize;
extern const std::uint8_t debug[];
extern const std::size_t debugSize;
} // namespace embedded

namespace {

using filament::math::float3;

struct Package {
    const char* name;
    const std::uint8_t* bytes;
    const std::size_t* size;
};
constexpr Package kPackages[] = {{"tissue", embedded::tissue, &embedded::tissueSize},
                                 {"metal", embedded::metal, &embedded::metalSize},
                                 {"gui", embedded::gui, &embedded::guiSize},
                                 {"canvas", embedded::canvas, &embedded::canvasSize},
                                 {"debug", embedded::debug, &embedded::debugSize}};

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

void applyTo(filament::MaterialInstance& instance, const MetalMaterial& m)
{
    setParameter(instance, "baseColor", linear(m.baseColor));
    setParameter(instance, "roughness", float(m.roughness));
}

} // namespace

template <class Value> void setParameter(filament::MaterialInstance& instance, const char* name, Value value)
{
    if (!instance.getMaterial()->hasParameter(name))
        fail("material '", instance.getMaterial()->getName(), "' has no parameter '", name, "'");
    instance.setParameter(name, value);
}
template void setParameter(filament::MaterialInstance&, const char*, float);
template void setParameter(filament::MaterialInstance&, const char*, float3);

MaterialPool::~MaterialPool()
{
    for (const auto& [name, material] : loaded_) engine_.destroy(material);
}

filament::Material& MaterialPool::get(const std::string& name)
{
    const auto found = loaded_.find(name);
    if (found != loaded_.end()) return *found->second;
    for (const Package& package : kPackages) {
        if (name != package.name) continue;
        filament::Material* material =
            filament::Material::Builder().package(package.bytes, *package.size).build(engine_);
        if (!material) fail("material '", name, "' does not load");
        loaded_[name] = material;
        return *material;
    }
    fail("there is no material '", name, "'");
}

filament::MaterialInstance* MaterialPool::instance(const Material& material)
{
    filament::MaterialInstance* made = get(nameOf(material)).createInstance();
    apply(material, *made);
    return made;
}

void MaterialPool::apply(const Material& material, filament::MaterialInstance& instance)
{
    std::visit([&](const auto& held) { applyTo(instance, held); }, material);
}

std::string MaterialPool::nameOf(const Material& material)
{
    return std::holds_alternative<TissueMaterial>(material) ? "tissue" : "metal";
}

} // namespace filasofia::visual
