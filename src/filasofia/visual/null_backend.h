#pragma once

#include "filasofia/visual/null_overlays.h"
#include "filasofia/visual/render_backend.h"

#include <map>

namespace filasofia::visual {

/// Draws nothing, keeps what it was given and counts the calls; for tests without a GPU.
class NullBackend final : public RenderBackend {
public:
    struct Body {
        BodyGeometry geometry;
        std::vector<PackedState> states;
        Material material;
        bool castShadows = true;
        std::uint32_t label = 0;
        bool visible = true;
        Pose pose;
        double scale = 1.0;
        int vertexCalls = 0;   ///< setVertices
        int geometryCalls = 0; ///< setGeometry
        int materialCalls = 0; ///< setMaterial
    };
    struct Placed {
        Pose pose;
        bool visible = true;
        int putCalls = 0;
        int width = 0; ///< [px], for an off-screen view
        int height = 0;
    };

    NullBackend(int width, int height) : width_(width), height_(height) {}

    void addBody(Slot slot, const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry) override;
    void setGeometry(Slot body, BodyGeometry geometry) override;
    void setVertices(Slot body, VertexData vertices) override;
    void setSurfaceState(Slot body, std::vector<PackedState> states) override;
    void setMaterial(Slot body, const ReadyMaterial& material) override;
    void putLight(Slot slot, const LightDef& def) override;
    void putCamera(Slot slot, const CameraDef& def) override;
    void putView(Slot slot, const ViewDef& def, Slot camera) override;
    void setEnvironment(const EnvironmentDef& def) override;
    void setSmoke(const Smoke& seen) override { smoke = seen; }
    void setPose(Slot entity, const Pose& world) override;
    void setScale(Slot body, double scale) override;
    void setVisible(Slot entity, bool visible) override;
    void remove(Slot entity) override;
    void resize(int width, int height) override;
    bool draw() override;
    Image capture() override;
    Image capture(Slot view) override;
    DepthImage captureDepth() override;
    DepthImage captureDepth(Slot view) override;
    OverlayBackend& overlays() override { return overlay; }

    std::map<Slot, Body> bodies;
    std::map<Slot, Placed> placed; ///< lights, cameras and views
    int frames = 0;
    int environmentCalls = 0;
    Smoke smoke;
    NullOverlays overlay;

private:
    int width_;
    int height_;
};

} // namespace filasofia::visual
