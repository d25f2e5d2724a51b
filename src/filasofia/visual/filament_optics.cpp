#include "filasofia/visual/filament_optics.h"

#include <filament/RenderableManager.h>
#include <filament/TextureSampler.h>
#include <math/vec2.h>
#include <utils/EntityManager.h>

#include <algorithm>

namespace filasofia::visual {
namespace {

struct ScreenCorner {
    float x, y, u, v;
};
// One triangle that covers the whole picture, in device coordinates.
constexpr ScreenCorner kScreenCorners[3] = {{-1, -1, 0, 0}, {3, -1, 2, 0}, {-1, 3, 0, 2}};
constexpr std::uint16_t kIndices[3] = {0, 1, 2};

} // namespace

DrawnPicture::DrawnPicture(filament::Engine& engine, int width, int height, Content content)
    : engine_(engine), width_(width), height_(height)
{
    using filament::RenderTarget;
    using filament::Texture;
    const auto make = [&](Texture::InternalFormat format, Texture::Usage usage) {
        return Texture::Builder()
            .width(std::uint32_t(width))
            .height(std::uint32_t(height))
            .levels(1)
            .format(format)
            .usage(usage)
            .build(engine);
    };
    const bool numbers = content == Content::Numbers;
    const auto colours = content == Content::Light ? Texture::InternalFormat::RGBA16F : Texture::InternalFormat::RGBA8;
    texture_ = make(numbers ? Texture::InternalFormat::RG32F : colours,
                    Texture::Usage::COLOR_ATTACHMENT | Texture::Usage::SAMPLEABLE);
    RenderTarget::Builder target;
    target.texture(RenderTarget::AttachmentPoint::COLOR, texture_);
    if (numbers) {
        nearest_ = make(Texture::InternalFormat::DEPTH32F, Texture::Usage::DEPTH_ATTACHMENT);
        target.texture(RenderTarget::AttachmentPoint::DEPTH, nearest_);
    }
    target_ = target.build(engine);
}

DrawnPicture::~DrawnPicture()
{
    engine_.destroy(target_);
    engine_.destroy(texture_);
    if (nearest_) engine_.destroy(nearest_);
}

OpticsPass::OpticsPass(filament::Engine& engine, MaterialPool& pool)
    : engine_(engine), scene_(engine.createScene()), view_(engine.createView()),
      instance_(pool.get("optics").createInstance()), triangle_(utils::EntityManager::get().create()),
      eye_(utils::EntityManager::get().create())
{
    using filament::VertexAttribute;
    using filament::VertexBuffer;
    constexpr std::uint8_t kStride = sizeof(ScreenCorner);
    vertices_ = VertexBuffer::Builder()
                    .vertexCount(3)
                    .bufferCount(1)
                    .attribute(VertexAttribute::POSITION, 0, VertexBuffer::AttributeType::FLOAT2, 0, kStride)
                    .attribute(VertexAttribute::UV0, 0, VertexBuffer::AttributeType::FLOAT2, 8, kStride)
                    .build(engine);
    vertices_->setBufferAt(engine, 0, {kScreenCorners, sizeof(kScreenCorners)});
    indices_ = filament::IndexBuffer::Builder()
                   .indexCount(3)
                   .bufferType(filament::IndexBuffer::IndexType::USHORT)
                   .build(engine);
    indices_->setBuffer(engine, {kIndices, sizeof(kIndices)});
    using Renderable = filament::RenderableManager;
    Renderable::Builder(1)
        .geometry(0, Renderable::PrimitiveType::TRIANGLES, vertices_, indices_)
        .material(0, instance_)
        .culling(false)
        .castShadows(false)
        .receiveShadows(false)
        .build(engine, triangle_);
    scene_->addEntity(triangle_);
    camera_ = engine.createCamera(eye_);
    view_->setScene(scene_);
    view_->setCamera(camera_);
    view_->setPostProcessingEnabled(false); // the picture is finished
    view_->setShadowingEnabled(false);
}

OpticsPass::~OpticsPass()
{
    engine_.destroy(view_);
    engine_.destroyCameraComponent(eye_);
    engine_.destroy(triangle_);
    utils::EntityManager::get().destroy(triangle_);
    utils::EntityManager::get().destroy(eye_);
    engine_.destroy(scene_);
    engine_.destroy(vertices_);
    engine_.destroy(indices_);
    engine_.destroy(instance_);
}

void OpticsPass::prepare(int width, int height, const EndoscopeOptics& optics)
{
    if (!picture_ || picture_->width() != width || picture_->height() != height) {
        picture_ = std::make_unique<DrawnPicture>(engine_, width, height);
        instance_->setParameter("picture", picture_->texture(),
                                filament::TextureSampler(filament::TextureSampler::MagFilter::LINEAR));
        const float smaller = static_cast<float>(std::min(width, height));
        setParameter(*instance_, "extent",
                     filament::math::float2{static_cast<float>(width) / smaller, static_cast<float>(height) / smaller});
    }
    setParameter(*instance_, "maskRadius", float(optics.maskRadius));
    setParameter(*instance_, "maskSoftness", float(optics.maskSoftness));
    setParameter(*instance_, "distortion", float(optics.distortion));
    setParameter(*instance_, "vignette", float(optics.vignette));
    setParameter(*instance_, "rimBlur", float(optics.rimBlur));
    setParameter(*instance_, "mist", float(optics.mist));
    setParameter(*instance_, "smear", float(optics.smear));
    setParameter(*instance_, "smearColor",
                 filament::math::float3{float(optics.smearColor.red), float(optics.smearColor.green),
                                        float(optics.smearColor.blue)});
}

} // namespace filasofia::visual
