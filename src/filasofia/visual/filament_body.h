#pragma once

#include "filasofia/visual/material_pool.h"
#include "filasofia/visual/render_backend.h"

#include <filament/IndexBuffer.h>
#include <filament/Scene.h>
#include <filament/VertexBuffer.h>
#include <utils/Entity.h>

namespace filasofia::visual {

/// One body's buffers, material instance and place in the scene.
class FilamentBody {
public:
    FilamentBody(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool, const ReadyMaterial& material,
                 const BodyTraits& traits, BodyGeometry geometry);
    FilamentBody(const FilamentBody&) = delete;
    FilamentBody& operator=(const FilamentBody&) = delete;
    ~FilamentBody();

    void setGeometry(BodyGeometry geometry);
    void setVertices(VertexData vertices);
    void setSurfaceState(std::vector<PackedState> states);
    /// Returns true if the body took another kind of material, and so new handles of the library.
    bool setMaterial(const ReadyMaterial& material);
    void setScale(double scale) { scale_ = scale; }
    [[nodiscard]] double scale() const { return scale_; }
    void setVisible(bool visible);
    [[nodiscard]] bool visible() const { return visible_; }
    [[nodiscard]] std::uint32_t label() const { return label_; }
    /// Whether both sides of its triangles are drawn.
    [[nodiscard]] bool twoSided() const;
    /// Looks like `other`, with the body's own culling, until wearOwn().
    void wear(filament::MaterialInstance& other);
    void wearOwn();
    [[nodiscard]] utils::Entity entity() const { return entity_; }

private:
    void buildBuffers(const BodyGeometry& geometry);
    void destroyBuffers();
    void put(filament::MaterialInstance& instance);

    filament::Engine& engine_;
    filament::Scene& scene_;
    MaterialPool& pool_;
    utils::Entity entity_;
    filament::VertexBuffer* vertices_ = nullptr;
    filament::IndexBuffer* indices_ = nullptr;
    filament::MaterialInstance* instance_ = nullptr;
    std::string materialName_;
    std::uint32_t label_;
    double scale_ = 1.0;
    bool visible_ = true;
};

} // namespace filasofia::visual
