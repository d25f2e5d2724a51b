#pragma once

#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/image.h"
#include "filasofia/visual/light.h"
#include "filasofia/visual/material_store.h"
#include "filasofia/visual/mesh_frames.h"
#include "filasofia/visual/overlay_backend.h"
#include "filasofia/visual/view.h"
#include "filasofia/visual/visual_server.h"

#include <array>
#include <memory>

namespace filament {
class Engine;
class Renderer;
class Scene;
class View;
} // namespace filament

namespace filasofia::visual {

/// An entity's number in the backend; the server gives it once, never 0.
using Slot = std::uint32_t;

/// The surface of a body as it is drawn, after subdivision.
struct BodyGeometry {
    std::vector<Float3> rest;             ///< [m], one per vertex; the pattern is fixed to them
    std::vector<std::uint32_t> indices;   ///< three vertices per triangle
    std::vector<std::array<float, 2>> uv; ///< one per vertex, or empty
    VertexData vertices;
};

/// In 255ths: blood, burn, wetness and seam, which are the vertex colour; then the heat, of which 0 means -1, and 255
/// means 3; the rest is empty.
using PackedState = std::array<std::uint8_t, 8>;

/// What stays with a body from its beginning to its end.
struct BodyTraits {
    bool castShadows = true;
    std::uint32_t label = 0; ///< in depth images
};

struct NativeObjects {
    filament::Engine* engine = nullptr;
    filament::Renderer* renderer = nullptr;
    filament::Scene* scene = nullptr;
};

/// The part that draws. Its input has been checked; a slot names one entity of one kind until remove().
class RenderBackend {
public:
    RenderBackend() = default;
    RenderBackend(const RenderBackend&) = delete;
    RenderBackend& operator=(const RenderBackend&) = delete;
    virtual ~RenderBackend() = default;

    virtual void addBody(Slot slot, const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry) = 0;
    virtual void setGeometry(Slot body, BodyGeometry geometry) = 0;
    virtual void setVertices(Slot body, VertexData vertices) = 0; ///< as many as the geometry has
    virtual void setSurfaceState(Slot body, std::vector<PackedState> states) = 0;
    virtual void setMaterial(Slot body, const ReadyMaterial& material) = 0;

    /// These make the entity or replace the former one.
    virtual void putLight(Slot slot, const LightDef& def) = 0;
    virtual void putCamera(Slot slot, const CameraDef& def) = 0;
    virtual void putView(Slot slot, const ViewDef& def, Slot camera) = 0;
    virtual void setEnvironment(const EnvironmentDef& def) = 0;
    virtual void setSmoke(const Smoke& smoke) = 0;

    virtual void setPose(Slot entity, const Pose& world) = 0; ///< body, light or camera
    virtual void setScale(Slot body, double scale) = 0;       ///< followed by setPose before the next frame
    virtual void setVisible(Slot entity, bool visible) = 0;   ///< body, light or view
    virtual void remove(Slot entity) = 0;

    virtual void resize(int width, int height) = 0;
    virtual bool draw() = 0;              ///< one frame; false: skipped
    virtual Image capture() = 0;          ///< draws and returns the picture; throws an Error if there is none
    virtual Image capture(Slot view) = 0; ///< the same for an off-screen view, after those made before it
    /// The depth of the views in the window, and of one view, at the present places of bodies and cameras.
    virtual DepthImage captureDepth() = 0;
    virtual DepthImage captureDepth(Slot view) = 0;

    [[nodiscard]] virtual OverlayBackend& overlays() = 0;

    virtual NativeObjects native() { return {}; }
    virtual filament::View* nativeView(Slot) { return nullptr; }
};

/// Throws an Error if it cannot start.
std::unique_ptr<RenderBackend> makeBackend(const VisualServerDef& def);

} // namespace filasofia::visual
