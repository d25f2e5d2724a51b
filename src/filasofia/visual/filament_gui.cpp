#include "filasofia/visual/filament_gui.h"

#include "filasofia/visual/owned_buffer.h"

#include <filament/RenderableManager.h>
#include <filament/TextureSampler.h>
#include <utils/EntityManager.h>

namespace filasofia::visual {
namespace {

constexpr std::size_t kMaxCommands = 4096; // limit of a renderable, and more than anybody could read

} // namespace

FilamentGui::FilamentGui(filament::Engine& engine, MaterialPool& pool)
    : engine_(engine), pool_(pool), scene_(engine.createScene()), view_(engine.createView()),
      eye_(utils::EntityManager::get().create()), triangles_(utils::EntityManager::get().create())
{
    camera_ = engine.createCamera(eye_);
    view_->setScene(scene_);
    view_->setCamera(camera_);
    view_->setPostProcessingEnabled(false); // its colours are final
    view_->setShadowingEnabled(false);
    view_->setFrustumCullingEnabled(false);
    view_->setBlendMode(filament::View::BlendMode::TRANSLUCENT); // over the existing picture
    scene_->addEntity(triangles_);
}

FilamentGui::~FilamentGui()
{
    scene_->remove(triangles_);
    engine_.destroy(triangles_); // before what it draws with
    utils::EntityManager::get().destroy(triangles_);
    for (filament::MaterialInstance* instance : instances_) engine_.destroy(instance);
    if (vertices_) engine_.destroy(vertices_);
    if (indices_) engine_.destroy(indices_);
    engine_.destroy(view_);
    engine_.destroy(scene_);
    engine_.destroyCameraComponent(eye_);
    utils::EntityManager::get().destroy(eye_);
    if (glyphs_) engine_.destroy(glyphs_);
}

void FilamentGui::setGlyphs(std::shared_ptr<const GlyphSheet> glyphs)
{
    filament::Texture* old = glyphs_;
    using filament::Texture;
    glyphs_ = Texture::Builder()
                  .width(std::uint32_t(glyphs->width))
                  .height(std::uint32_t(glyphs->height))
                  .levels(1)
                  .format(Texture::InternalFormat::R8)
                  .sampler(Texture::Sampler::SAMPLER_2D)
                  .build(engine_);
    auto* kept = new std::shared_ptr<const GlyphSheet>(std::move(glyphs));
    Texture::PixelBufferDescriptor pixels(
        (*kept)->coverage.data(), (*kept)->coverage.size(), Texture::Format::R, Texture::Type::UBYTE,
        [](void*, std::size_t, void* user) { delete static_cast<std::shared_ptr<const GlyphSheet>*>(user); }, kept);
    pixels.alignment = 1;
    glyphs_->setImage(engine_, 0, std::move(pixels));
    const filament::TextureSampler sampler(filament::TextureSampler::MinFilter::LINEAR,
                                           filament::TextureSampler::MagFilter::LINEAR);
    for (filament::MaterialInstance* instance : instances_) instance->setParameter("glyphs", glyphs_, sampler);
    if (old) engine_.destroy(old);
    picture_ = {}; // its glyph coordinates are no longer valid
    buildRenderable();
}

bool FilamentGui::setPicture(GuiPicture picture)
{
    if (picture.commands.size() > kMaxCommands) picture.commands.resize(kMaxCommands);
    if (picture == picture_) return false;
    picture_ = std::move(picture);
    upload();
    buildRenderable();
    return true;
}

void FilamentGui::setViewport(const filament::Viewport& pixels)
{
    view_->setViewport(pixels);
    if (pixels.left == pixels_.left && pixels.bottom == pixels_.bottom && pixels.width == pixels_.width &&
        pixels.height == pixels_.height)
        return;
    pixels_ = pixels;
    camera_->setProjection(filament::Camera::Projection::ORTHO, 0.0, pixels.width, pixels.height, 0.0, 0.0, 1.0);
    setScissors();
}

void FilamentGui::growBuffers()
{
    using Attribute = filament::VertexAttribute;
    using Type = filament::VertexBuffer::AttributeType;
    if (vertexRoom_ < picture_.vertices.size()) {
        if (vertices_) engine_.destroy(vertices_);
        vertexRoom_ = roomFor(picture_.vertices.size());
        vertices_ = filament::VertexBuffer::Builder()
                        .vertexCount(std::uint32_t(vertexRoom_))
                        .bufferCount(1)
                        .attribute(Attribute::POSITION, 0, Type::FLOAT2, offsetof(GuiVertex, x), sizeof(GuiVertex))
                        .attribute(Attribute::UV0, 0, Type::FLOAT2, offsetof(GuiVertex, u), sizeof(GuiVertex))
                        .attribute(Attribute::COLOR, 0, Type::UBYTE4, offsetof(GuiVertex, color), sizeof(GuiVertex))
                        .normalized(Attribute::COLOR)
                        .build(engine_);
    }
    if (indexRoom_ < picture_.indices.size()) {
        if (indices_) engine_.destroy(indices_);
        indexRoom_ = roomFor(picture_.indices.size());
        indices_ = filament::IndexBuffer::Builder()
                       .indexCount(std::uint32_t(indexRoom_))
                       .bufferType(filament::IndexBuffer::IndexType::UINT)
                       .build(engine_);
    }
}

void FilamentGui::upload()
{
    if (picture_.commands.empty()) return;
    auto& renderables = engine_.getRenderableManager();
    renderables.destroy(triangles_); // before the buffers that it draws with
    growBuffers();
    vertices_->setBufferAt(engine_, 0, ownedBuffer(picture_.vertices));
    indices_->setBuffer(engine_, ownedBuffer(picture_.indices));
}

void FilamentGui::buildRenderable()
{
    engine_.getRenderableManager().destroy(triangles_);
    const std::size_t count = picture_.commands.size();
    if (count == 0) return;
    const filament::TextureSampler sampler(filament::TextureSampler::MinFilter::LINEAR,
                                           filament::TextureSampler::MagFilter::LINEAR);
    while (instances_.size() < count) {
        instances_.push_back(pool_.get("gui").createInstance());
        instances_.back()->setParameter("glyphs", glyphs_, sampler);
    }
    using Renderable = filament::RenderableManager;
    Renderable::Builder builder(count);
    builder.boundingBox({{0, 0, 0}, {1e4F, 1e4F, 1e4F}}).culling(false).castShadows(false).receiveShadows(false);
    for (std::size_t i = 0; i < count; ++i) {
        const GuiCommand& command = picture_.commands[i];
        builder
            .geometry(i, Renderable::PrimitiveType::TRIANGLES, vertices_, indices_, command.firstIndex,
                      command.indexCount)
            .material(i, instances_[i])
            .blendOrder(i, std::uint16_t(i));
    }
    builder.build(engine_, triangles_);
    setScissors();
}

void FilamentGui::setScissors()
{
    for (std::size_t i = 0; i < picture_.commands.size(); ++i) {
        const PixelArea& clip = picture_.commands[i].clip;
        // Filament counts scissors in the target, not in the view.
        const int left = pixels_.left + clip.left;
        const int bottom = pixels_.bottom + std::max(int(pixels_.height) - clip.bottom, 0);
        instances_[i]->setScissor(std::uint32_t(left), std::uint32_t(bottom), std::uint32_t(clip.width()),
                                  std::uint32_t(clip.height()));
    }
}

} // namespace filasofia::visual
