#include "filasofia/visual/filament_debug.h"

#include "filasofia/visual/owned_buffer.h"

#include <filament/RenderableManager.h>
#include <utils/EntityManager.h>

namespace filasofia::visual {
namespace {

/// A vertex in the layout of the graphics card.
struct Packed {
    Float3 position;
    Float3 other;
    float width;
    float side[2];
    std::array<std::uint8_t, 4> color;
};

} // namespace

FilamentDebug::FilamentDebug(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool, bool onTop)
    : engine_(engine), scene_(scene), shapes_(utils::EntityManager::get().create()),
      instance_(pool.get("debug").createInstance()), onTop_(onTop)
{
    if (!onTop) return;
    instance_->setDepthCulling(false);
    instance_->setDepthWrite(false);
}

FilamentDebug::~FilamentDebug()
{
    scene_.remove(shapes_);
    engine_.destroy(shapes_); // before what it draws with
    utils::EntityManager::get().destroy(shapes_);
    engine_.destroy(instance_);
    if (vertices_) engine_.destroy(vertices_);
    if (indices_) engine_.destroy(indices_);
}

void FilamentDebug::growBuffers(const DebugLayer& layer)
{
    using Attribute = filament::VertexAttribute;
    using Type = filament::VertexBuffer::AttributeType;
    if (vertexRoom_ < layer.vertices.size()) {
        if (vertices_) engine_.destroy(vertices_);
        vertexRoom_ = roomFor(layer.vertices.size());
        vertices_ = filament::VertexBuffer::Builder()
                        .vertexCount(std::uint32_t(vertexRoom_))
                        .bufferCount(1)
                        .attribute(Attribute::POSITION, 0, Type::FLOAT3, offsetof(Packed, position), sizeof(Packed))
                        .attribute(Attribute::CUSTOM0, 0, Type::FLOAT4, offsetof(Packed, other), sizeof(Packed))
                        .attribute(Attribute::UV0, 0, Type::FLOAT2, offsetof(Packed, side), sizeof(Packed))
                        .attribute(Attribute::COLOR, 0, Type::UBYTE4, offsetof(Packed, color), sizeof(Packed))
                        .normalized(Attribute::COLOR)
                        .build(engine_);
    }
    if (indexRoom_ < layer.indices.size()) {
        if (indices_) engine_.destroy(indices_);
        indexRoom_ = roomFor(layer.indices.size());
        indices_ = filament::IndexBuffer::Builder()
                       .indexCount(std::uint32_t(indexRoom_))
                       .bufferType(filament::IndexBuffer::IndexType::UINT)
                       .build(engine_);
    }
}

void FilamentDebug::upload(const DebugLayer& layer)
{
    std::vector<Packed> packed;
    packed.reserve(layer.vertices.size());
    for (const DebugVertex& v : layer.vertices)
        packed.push_back({v.position, v.other, v.width, {float(v.side[0]), float(v.side[1])}, v.color});
    vertices_->setBufferAt(engine_, 0, ownedBuffer(std::move(packed)));
    indices_->setBuffer(engine_, ownedBuffer(layer.indices));
}

void FilamentDebug::build(std::size_t indexCount)
{
    using Renderable = filament::RenderableManager;
    Renderable::Builder(1)
        .boundingBox({{0, 0, 0}, {1e6F, 1e6F, 1e6F}})
        .culling(false)
        .geometry(0, Renderable::PrimitiveType::TRIANGLES, vertices_, indices_, 0, indexCount)
        .material(0, instance_)
        .priority(onTop_ ? 7 : 4) // 7 is drawn last
        .castShadows(false)
        .receiveShadows(false)
        .build(engine_, shapes_);
}

void FilamentDebug::set(const DebugLayer& layer)
{
    const bool something = !layer.indices.empty();
    if (!something && !shown_) return;
    engine_.getRenderableManager().destroy(shapes_); // before the buffers that it draws with
    if (something) {
        growBuffers(layer);
        upload(layer);
        build(layer.indices.size());
    }
    if (something != shown_) {
        if (something)
            scene_.addEntity(shapes_);
        else
            scene_.remove(shapes_);
    }
    shown_ = something;
}

} // namespace filasofia::visual
