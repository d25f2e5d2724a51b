#include "filasofia/visual/filament_body.h"

#include <backend/BufferDescriptor.h>
#include <filament/Box.h>
#include <filament/Material.h>
#include <filament/RenderableManager.h>
#include <filament/TransformManager.h>
#include <utils/EntityManager.h>

#include <cstring>

namespace filasofia::visual {
namespace {

// Buffers are scarce (see FilamentBackend::addBody), so data that change together share one.
enum Stream : std::uint8_t { kShape, kRest, kStates, kStreamCount };

/// The data that stay while a body deforms.
struct RestVertex {
    Float3 position;
    std::array<float, 2> uv = {};
};

/// A buffer descriptor that owns its data, because the upload happens later, on Filament's thread.
template <class T> filament::backend::BufferDescriptor owned(std::vector<T> data)
{
    auto* kept = new std::vector<T>(std::move(data));
    return {kept->data(), kept->size() * sizeof(T),
            [](void*, std::size_t, void* user) { delete static_cast<std::vector<T>*>(user); }, kept};
}

filament::Box boxOf(const VertexData& data)
{
    // Filament does not accept a flat box: a plane gets an invisible thickness.
    constexpr float kThin = 1e-5F;
    return {{0.5F * (data.low.x + data.high.x), 0.5F * (data.low.y + data.high.y), 0.5F * (data.low.z + data.high.z)},
            {0.5F * (data.high.x - data.low.x) + kThin, 0.5F * (data.high.y - data.low.y) + kThin,
             0.5F * (data.high.z - data.low.z) + kThin}};
}

} // namespace

FilamentBody::FilamentBody(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool,
                           const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry)
    : engine_(engine), scene_(scene), pool_(pool), entity_(utils::EntityManager::get().create()),
      instance_(pool.instance(material)), materialName_(MaterialPool::nameOf(material.material)), label_(traits.label)
{
    buildBuffers(geometry);
    using Renderable = filament::RenderableManager;
    Renderable::Builder(1)
        .boundingBox(boxOf(geometry.vertices))
        .geometry(0, Renderable::PrimitiveType::TRIANGLES, vertices_, indices_)
        .material(0, instance_)
        .castShadows(traits.castShadows)
        .receiveShadows(true)
        .build(engine_, entity_);
    engine_.getTransformManager().create(entity_);
    setVertices(std::move(geometry.vertices));
    scene_.addEntity(entity_);
}

FilamentBody::~FilamentBody()
{
    scene_.remove(entity_);
    engine_.destroy(entity_); // before what it draws with
    utils::EntityManager::get().destroy(entity_);
    destroyBuffers();
    engine_.destroy(instance_);
}

void FilamentBody::buildBuffers(const BodyGeometry& geometry)
{
    using Attribute = filament::VertexAttribute;
    using Type = filament::VertexBuffer::AttributeType;
    const std::size_t count = geometry.rest.size();
    vertices_ = filament::VertexBuffer::Builder()
                    .vertexCount(static_cast<std::uint32_t>(count))
                    .bufferCount(kStreamCount)
                    .attribute(Attribute::POSITION, kShape, Type::FLOAT3, 0, sizeof(Float3))
                    .attribute(Attribute::TANGENTS, kShape, Type::SHORT4, std::uint32_t(count * sizeof(Float3)),
                               sizeof(PackedFrame))
                    .normalized(Attribute::TANGENTS)
                    .attribute(Attribute::CUSTOM0, kRest, Type::FLOAT3, 0, sizeof(RestVertex))
                    .attribute(Attribute::UV0, kRest, Type::FLOAT2, sizeof(Float3), sizeof(RestVertex))
                    .attribute(Attribute::COLOR, kStates, Type::UBYTE4, 0, sizeof(PackedState))
                    .normalized(Attribute::COLOR)
                    .attribute(Attribute::CUSTOM1, kStates, Type::UBYTE4, 4, sizeof(PackedState))
                    .normalized(Attribute::CUSTOM1)
                    .build(engine_);
    std::vector<RestVertex> rest(count);
    for (std::size_t i = 0; i < count; ++i) {
        rest[i].position = geometry.rest[i];
        if (!geometry.uv.empty()) rest[i].uv = geometry.uv[i]; // otherwise the materials do not read them
    }
    vertices_->setBufferAt(engine_, kRest, owned(std::move(rest)));
    vertices_->setBufferAt(engine_, kStates, owned(std::vector<PackedState>(count)));
    indices_ = filament::IndexBuffer::Builder()
                   .indexCount(static_cast<std::uint32_t>(geometry.indices.size()))
                   .bufferType(filament::IndexBuffer::IndexType::UINT)
                   .build(engine_);
    indices_->setBuffer(engine_, owned(geometry.indices));
}

void FilamentBody::destroyBuffers()
{
    engine_.destroy(vertices_);
    engine_.destroy(indices_);
}

void FilamentBody::setGeometry(BodyGeometry geometry)
{
    filament::VertexBuffer* oldVertices = vertices_;
    filament::IndexBuffer* oldIndices = indices_;
    buildBuffers(geometry);
    auto& renderables = engine_.getRenderableManager();
    renderables.setGeometryAt(renderables.getInstance(entity_), 0,
                              filament::RenderableManager::PrimitiveType::TRIANGLES, vertices_, indices_, 0,
                              geometry.indices.size());
    engine_.destroy(oldVertices);
    engine_.destroy(oldIndices);
    setVertices(std::move(geometry.vertices));
}

void FilamentBody::setVertices(VertexData vertices)
{
    auto& renderables = engine_.getRenderableManager();
    renderables.setAxisAlignedBoundingBox(renderables.getInstance(entity_), boxOf(vertices));
    // All positions, then all frames.
    const std::size_t positions = vertices.positions.size() * sizeof(Float3);
    std::vector<std::byte> shape(positions + vertices.frames.size() * sizeof(PackedFrame));
    std::memcpy(shape.data(), vertices.positions.data(), positions);
    std::memcpy(shape.data() + positions, vertices.frames.data(), shape.size() - positions);
    vertices_->setBufferAt(engine_, kShape, owned(std::move(shape)));
}

void FilamentBody::setSurfaceState(std::vector<PackedState> states)
{
    vertices_->setBufferAt(engine_, kStates, owned(std::move(states)));
}

bool FilamentBody::setMaterial(const ReadyMaterial& material)
{
    if (MaterialPool::nameOf(material.material) == materialName_) {
        pool_.apply(material, *instance_);
        return false;
    }
    filament::MaterialInstance* old = instance_;
    instance_ = pool_.instance(material);
    materialName_ = MaterialPool::nameOf(material.material);
    put(*instance_);
    engine_.destroy(old);
    return true;
}

void FilamentBody::put(filament::MaterialInstance& instance)
{
    auto& renderables = engine_.getRenderableManager();
    renderables.setMaterialInstanceAt(renderables.getInstance(entity_), 0, &instance);
}

bool FilamentBody::twoSided() const
{
    const filament::Material& own = *instance_->getMaterial();
    return own.isDoubleSided() || own.getCullingMode() == filament::Material::CullingMode::NONE;
}

void FilamentBody::wear(filament::MaterialInstance& other)
{
    using Culling = filament::Material::CullingMode;
    other.setCullingMode(twoSided() ? Culling::NONE : instance_->getMaterial()->getCullingMode());
    put(other);
}

void FilamentBody::wearOwn() { put(*instance_); }

void FilamentBody::setVisible(bool visible)
{
    if (visible == visible_) return;
    visible_ = visible;
    if (visible)
        scene_.addEntity(entity_);
    else
        scene_.remove(entity_);
}

} // namespace filasofia::visual
