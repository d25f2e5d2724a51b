#include "filasofia/visual/filament_canvas.h"

#include "filasofia/visual/owned_buffer.h"
#include "filasofia/visual/pose_matrix.h"

#include <filament/RenderableManager.h>
#include <filament/TextureSampler.h>
#include <filament/TransformManager.h>
#include <utils/EntityManager.h>

#include <bit>

namespace filasofia::visual {
namespace {

struct SheetCorner {
    float x, y, z, u, v;
};

} // namespace

FilamentCanvas::FilamentCanvas(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool,
                               const CanvasSize& size)
    : engine_(engine), scene_(scene), gui_(engine, pool), sheet_(utils::EntityManager::get().create()),
      instance_(pool.get("canvas").createInstance())
{
    makeTarget(size.pixelWidth, size.pixelHeight);
    makeSheet(size.width, size.height);
}

FilamentCanvas::~FilamentCanvas()
{
    scene_.remove(sheet_);
    engine_.destroy(sheet_); // before what it draws with
    utils::EntityManager::get().destroy(sheet_);
    engine_.destroy(instance_);
    engine_.destroy(corners_);
    engine_.destroy(indices_);
    gui_.view().setRenderTarget(nullptr);
    engine_.destroy(target_);
    engine_.destroy(picture_);
}

void FilamentCanvas::makeTarget(int pixelWidth, int pixelHeight)
{
    using filament::Texture;
    const auto levels = std::bit_width(unsigned(std::min(pixelWidth, pixelHeight)));
    picture_ = Texture::Builder()
                   .width(std::uint32_t(pixelWidth))
                   .height(std::uint32_t(pixelHeight))
                   .levels(std::uint8_t(levels))
                   .usage(Texture::Usage::COLOR_ATTACHMENT | Texture::Usage::SAMPLEABLE)
                   .format(Texture::InternalFormat::RGBA8) // not SRGB8, because ImGui blends in sRGB
                   .build(engine_);
    target_ = filament::RenderTarget::Builder()
                  .texture(filament::RenderTarget::AttachmentPoint::COLOR, picture_)
                  .build(engine_);
    gui_.view().setRenderTarget(target_);
    gui_.setViewport({0, 0, std::uint32_t(pixelWidth), std::uint32_t(pixelHeight)});
    filament::TextureSampler sampler(filament::TextureSampler::MinFilter::LINEAR_MIPMAP_LINEAR,
                                     filament::TextureSampler::MagFilter::LINEAR);
    sampler.setAnisotropy(8.0F); // keeps oblique views sharp
    instance_->setParameter("picture", picture_, sampler);
}

void FilamentCanvas::makeSheet(double width, double height)
{
    const auto x = float(0.5 * width), y = float(0.5 * height);
    using Attribute = filament::VertexAttribute;
    using Type = filament::VertexBuffer::AttributeType;
    corners_ = filament::VertexBuffer::Builder()
                   .vertexCount(4)
                   .bufferCount(1)
                   .attribute(Attribute::POSITION, 0, Type::FLOAT3, 0, sizeof(SheetCorner))
                   .attribute(Attribute::UV0, 0, Type::FLOAT2, 3 * sizeof(float), sizeof(SheetCorner))
                   .build(engine_);
    corners_->setBufferAt(
        engine_, 0,
        ownedBuffer(std::vector<SheetCorner>{{-x, -y, 0, 0, 0}, {x, -y, 0, 1, 0}, {-x, y, 0, 0, 1}, {x, y, 0, 1, 1}}));
    indices_ = filament::IndexBuffer::Builder()
                   .indexCount(6)
                   .bufferType(filament::IndexBuffer::IndexType::UINT)
                   .build(engine_);
    indices_->setBuffer(engine_, ownedBuffer(std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3}));
    using Renderable = filament::RenderableManager;
    Renderable::Builder(1)
        .boundingBox({{0, 0, 0}, {x, y, 1e-5F}})
        .geometry(0, Renderable::PrimitiveType::TRIANGLES, corners_, indices_)
        .material(0, instance_)
        .castShadows(false)
        .receiveShadows(false)
        .build(engine_, sheet_);
    engine_.getTransformManager().create(sheet_);
}

void FilamentCanvas::setPicture(const Pose& world, GuiPicture picture)
{
    auto& transforms = engine_.getTransformManager();
    transforms.setTransform(transforms.getInstance(sheet_), matrixOf(world));
    changed_ = gui_.setPicture(std::move(picture)) || changed_;
    if (shown_ == !gui_.empty()) return;
    shown_ = !gui_.empty();
    if (shown_)
        scene_.addEntity(sheet_);
    else
        scene_.remove(sheet_);
}

void FilamentCanvas::draw(filament::Renderer& renderer)
{
    if (!changed_ || !shown_) return;
    renderer.render(&gui_.view());
    picture_->generateMipmaps(engine_);
    changed_ = false;
}

} // namespace filasofia::visual
