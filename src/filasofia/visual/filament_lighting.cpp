// The lights and surroundings of FilamentBackend.
#include "filasofia/visual/environment.h"
#include "filasofia/visual/filament_backend.h"

#include <backend/PixelBufferDescriptor.h>
#include <filament/LightManager.h>
#include <utils/EntityManager.h>

#include <algorithm>
#include <cmath>

namespace filasofia::visual {
namespace {

using filament::LightManager;

LightManager::ShadowOptions shadowsFor(double range)
{
    LightManager::ShadowOptions options;
    options.mapSize = 2048;
    options.constantBias = static_cast<float>(2e-4 * std::min(range, 1.0)); // [m]
    options.normalBias = 1.0F;                                              // [texel]
    options.shadowNearHint = static_cast<float>(0.01 * range);
    options.shadowFarHint = static_cast<float>(range);
    return options;
}

LightManager::Builder builderFor(const SpotLight& spot)
{
    LightManager::Builder builder(LightManager::Type::FOCUSED_SPOT);
    builder.intensityCandela(float(spot.intensity))
        .falloff(float(spot.range))
        .spotLightCone(float(spot.innerAngle), float(spot.outerAngle))
        .shadowOptions(shadowsFor(spot.range));
    return builder;
}

LightManager::Builder builderFor(const DirectionalLight& light)
{
    LightManager::Builder builder(LightManager::Type::DIRECTIONAL);
    builder.intensity(float(light.illuminance)).shadowOptions(shadowsFor(1.0));
    return builder;
}

LightManager::Builder builderFor(const PointLight& light)
{
    LightManager::Builder builder(LightManager::Type::POINT);
    builder.intensityCandela(float(light.intensity)).falloff(float(light.range));
    return builder;
}

constexpr int kCubeSize = 64;
constexpr int kCubeLevels = 5;

/// Filament looks up a perceptual roughness r at level (levels - 1) r (2 - r).
double roughnessOfLevel(int level) { return 1.0 - std::sqrt(1.0 - double(level) / (kCubeLevels - 1)); }

filament::Texture* makeReflections(filament::Engine& engine, const EnvironmentDef& def)
{
    using filament::Texture;
    Texture* cube = Texture::Builder()
                        .width(kCubeSize)
                        .height(kCubeSize)
                        .levels(kCubeLevels)
                        .sampler(Texture::Sampler::SAMPLER_CUBEMAP)
                        .format(Texture::InternalFormat::R11F_G11F_B10F)
                        .build(engine);
    for (int level = 0; level < kCubeLevels; ++level) {
        const int size = kCubeSize >> level;
        auto* texels = new std::vector<Float3>(reflectionCube(def, size, roughnessOfLevel(level)));
        Texture::PixelBufferDescriptor pixels(
            texels->data(), texels->size() * sizeof(Float3), Texture::Format::RGB, Texture::Type::FLOAT,
            [](void*, std::size_t, void* user) { delete static_cast<std::vector<Float3>*>(user); }, texels);
        cube->setImage(engine, std::size_t(level), std::move(pixels),
                       Texture::FaceOffsets(std::size_t(size) * std::size_t(size) * sizeof(Float3)));
    }
    return cube;
}

} // namespace

void FilamentBackend::putLight(Slot slot, const LightDef& def)
{
    const auto [place, isNew] = lights_.try_emplace(slot);
    if (isNew) place->second.entity = makePlace();
    const utils::Entity entity = place->second.entity;
    place->second.seen.def = def;
    engine_->getLightManager().destroy(entity); // destroys the former light, if any
    std::visit([&](const auto& kind) { return builderFor(kind); }, def.kind)
        .color({float(def.color.red), float(def.color.green), float(def.color.blue)})
        .position({0.0F, 0.0F, 0.0F})
        .direction({0.0F, 0.0F, -1.0F})
        .castShadows(def.castShadows && !std::holds_alternative<PointLight>(def.kind))
        .build(*engine_, entity);
    if (isNew) scene_->addEntity(entity);
}

void FilamentBackend::setSmoke(const Smoke& smoke)
{
    if (!smoke_) smoke_ = std::make_unique<SmokePass>(*engine_, *scene_, *pool_);
    smoke_->set(smoke);
}

void FilamentBackend::lightSmoke()
{
    if (!smoke_ || smoke_->empty()) return;
    std::vector<SmokeLight> lights;
    for (const auto& [slot, each] : lights_) lights.push_back(each.seen);
    const Float3 mean = irradianceHarmonics(environment_)[0];
    const double strength = environment_.intensity;
    smoke_->light(lights, {strength * mean.x, strength * mean.y, strength * mean.z});
}

void FilamentBackend::setEnvironment(const EnvironmentDef& def)
{
    environment_ = def;
    destroyEnvironment();
    const std::array<Float3, 9> harmonics = irradianceHarmonics(def);
    filament::math::float3 coefficients[9];
    for (std::size_t i = 0; i < 9; ++i) coefficients[i] = {harmonics[i].x, harmonics[i].y, harmonics[i].z};
    reflections_ = makeReflections(*engine_, def);
    surroundings_ = filament::IndirectLight::Builder()
                        .reflections(reflections_)
                        .irradiance(3, coefficients)
                        .intensity(float(def.intensity))
                        .build(*engine_);
    scene_->setIndirectLight(surroundings_);

    // Clearing applies to the window, once per frame; only a skybox covers what other views left in the buffers they
    // share.
    background_ = filament::Skybox::Builder()
                      .color({float(def.background.red), float(def.background.green), float(def.background.blue), 1.0F})
                      .build(*engine_);
    scene_->setSkybox(background_);
}

void FilamentBackend::destroyEnvironment()
{
    if (!surroundings_) return;
    scene_->setIndirectLight(nullptr);
    scene_->setSkybox(nullptr);
    engine_->destroy(background_);
    engine_->destroy(surroundings_);
    engine_->destroy(reflections_);
    surroundings_ = nullptr;
    reflections_ = nullptr;
}

} // namespace filasofia::visual
