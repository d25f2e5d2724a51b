#pragma once

#include "filasofia/visual/material_pool.h"
#include "filasofia/visual/overlay_backend.h"

#include <filament/IndexBuffer.h>
#include <filament/Scene.h>
#include <filament/VertexBuffer.h>
#include <utils/Entity.h>

namespace filasofia::visual {

/// One layer of debug drawings in the scene.
class FilamentDebug {
public:
    FilamentDebug(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool, bool onTop);
    ~FilamentDebug();
    FilamentDebug(const FilamentDebug&) = delete;
    FilamentDebug& operator=(const FilamentDebug&) = delete;

    void set(const DebugLayer& layer);

private:
    void growBuffers(const DebugLayer& layer);
    void upload(const DebugLayer& layer);
    void build(std::size_t indexCount);

    filament::Engine& engine_;
    filament::Scene& scene_;
    utils::Entity shapes_;
    filament::MaterialInstance* instance_;
    filament::VertexBuffer* vertices_ = nullptr;
    filament::IndexBuffer* indices_ = nullptr;
    std::size_t vertexRoom_ = 0, indexRoom_ = 0;
    bool onTop_;
    bool shown_ = false;
};

} // namespace filasofia::visual
