#pragma once

#include "filasofia/visual/filament_body.h"
#include "filasofia/visual/filament_depth.h"
#include "filasofia/visual/filament_optics.h"
#include "filasofia/visual/filament_overlays.h"
#include "filasofia/visual/filament_smoke.h"

#include <filament/Camera.h>
#include <filament/ColorGrading.h>
#include <filament/IndirectLight.h>
#include <filament/Renderer.h>
#include <filament/Skybox.h>
#include <filament/SwapChain.h>
#include <filament/Texture.h>
#include <filament/View.h>

#include <map>

namespace filasofia::visual {

/// Draws with Filament's OpenGL backend: into an X11 window, or into memory.
class FilamentBackend final : public RenderBackend {
public:
    /// Throws an Error if it cannot start.
    explicit FilamentBackend(const VisualServerDef& def);
    ~FilamentBackend() override;

    void addBody(Slot slot, const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry) override;
    void setGeometry(Slot body, BodyGeometry geometry) override;
    void setVertices(Slot body, VertexData vertices) override;
    void setSurfaceState(Slot body, std::vector<PackedState> states) override;
    void setMaterial(Slot body, const ReadyMaterial& material) override;
    void putLight(Slot slot, const LightDef& def) override;
    void putCamera(Slot slot, const CameraDef& def) override;
    void putView(Slot slot, const ViewDef& def, Slot camera) override;
    void setEnvironment(const EnvironmentDef& def) override;
    void setSmoke(const Smoke& smoke) override;
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
    NativeObjects native() override { return {engine_, renderer_, scene_}; }
    OverlayBackend& overlays() override { return *overlays_; }
    filament::View* nativeView(Slot view) override { return views_.at(view).view; }

private:
    struct PlacedCamera {
        utils::Entity entity;
        filament::Camera* camera = nullptr;
        CameraDef def;
        Pose pose = {};
        double blurScale = 1.0; ///< [-], see exposeCamera
    };
    struct PlacedLight {
        utils::Entity entity;
        SmokeLight seen; ///< as smoke sees it
    };
    struct PlacedView {
        filament::View* view = nullptr;
        ViewDef def;
        Slot camera = 0;
        bool visible = true;
        std::unique_ptr<DrawnPicture> picture; ///< for an off-screen view
        std::unique_ptr<OpticsPass> optics;    ///< if it has endoscope optics
    };

    void start(const VisualServerDef& def);
    void stop();
    utils::Entity makePlace();
    void destroyPlace(utils::Entity entity);
    void destroyEnvironment();
    void drawViews();
    /// Draws one view by `render(filament::View*)`.
    template <class Render> void drawView(PlacedView& view, Render&& render);
    /// The light of the smoke, before the views of a frame.
    void lightSmoke();
    /// Sets the view's projection for a picture of this size: two views of different shape may share a camera.
    void project(PlacedView& view, const filament::Viewport& pixels);
    DepthImage drawDepth(PlacedView& view);
    void prepareOptics();
    [[nodiscard]] filament::Viewport pixelsOfView(const PlacedView& view) const;
    void applyView(PlacedView& view);
    void destroyView(PlacedView& view);
    Image read(filament::RenderTarget* target, int width, int height, bool endsFrame);
    /// Begins a frame. Returns false if Filament refuses even after several tries.
    bool beginFrame(int tries);

    /// Call it when handles were taken or given back. Destroyed handles are free only after Filament's thread has
    /// processed them, so this waits for it from time to time.
    void countHandles();
    /// Clears the window if no view draws into it.
    void clearWindow();

    int handlesTaken_ = 0;
    filament::View* blank_ = nullptr; ///< a view of an empty scene
    filament::Scene* nothing_ = nullptr;
    utils::Entity nobody_; ///< the blank view's camera
    bool headless_;
    int width_;
    int height_;
    void* nativeWindow_;
    std::unique_ptr<filament::backend::Platform> platform_; ///< outlives the engine
    filament::Engine* engine_ = nullptr;
    filament::Renderer* renderer_ = nullptr;
    filament::SwapChain* swapChain_ = nullptr;
    filament::Scene* scene_ = nullptr;
    filament::ColorGrading* grading_ = nullptr;
    filament::Texture* reflections_ = nullptr;
    filament::IndirectLight* surroundings_ = nullptr;
    filament::Skybox* background_ = nullptr;
    std::unique_ptr<MaterialPool> pool_;
    std::unique_ptr<FilamentOverlays> overlays_;
    std::unique_ptr<SmokePass> smoke_; ///< from the first smoke on
    EnvironmentDef environment_;
    std::unique_ptr<DepthPass> depth_; ///< from the first depth image on
    std::map<Slot, std::unique_ptr<FilamentBody>> bodies_;
    std::map<Slot, PlacedLight> lights_;
    std::map<Slot, PlacedCamera> cameras_;
    std::map<Slot, PlacedView> views_; ///< in the order in which they were made: later ones lie on top
};

} // namespace filasofia::visual
