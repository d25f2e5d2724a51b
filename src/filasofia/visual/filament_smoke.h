#pragma once

#include "filasofia/visual/filament_depth.h"
#include "filasofia/visual/float3.h"
#include "filasofia/visual/smoke.h"

#include <filament/IndexBuffer.h>
#include <filament/Scene.h>
#include <filament/VertexBuffer.h>
#include <filament/View.h>

namespace filasofia::visual {

/// A light as smoke sees it.
struct SmokeLight {
    LightDef def = {};
    Pose pose = {};
    bool visible = true;
};

/// The camera that smoke is drawn for.
struct SmokeEye {
    filament::Camera* camera = nullptr;
    Pose pose = {};
    CameraDef def = {};
    double aspect = 1.0; ///< [-], width over height of the picture
};

/// Smoke in the views: drawn into a small picture up to the surfaces behind, which one triangle then lays over the
/// scene before its colours are finished. As long as there is none, nothing is drawn.
class SmokePass {
public:
    SmokePass(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool);
    SmokePass(const SmokePass&) = delete;
    SmokePass& operator=(const SmokePass&) = delete;
    ~SmokePass();

    void set(const Smoke& smoke);
    [[nodiscard]] bool empty() const { return smoke_.puffs.empty() && !(smoke_.haze > 0.0); }
    /// The light of puffs and haze, once per frame, before it begins. `ambient` [lx] is that of the surroundings from
    /// all sides.
    void light(const std::vector<SmokeLight>& lights, const std::array<double, 3>& ambient);
    /// Before a view is drawn by `render(filament::View*)`: the smoke in it.
    template <class Render> void draw(Render&& render, const SmokeEye& eye, const DepthPass::Bodies& bodies)
    {
        depth_.drawDepth(render, *eye.camera, bodies, 2 * kWidth, 2 * kHeight);
        upload(eye);
        view_->setCamera(eye.camera);
        render(view_);
    }

private:
    static constexpr int kWidth = 320, kHeight = 240; ///< [px], the small picture, whatever the view's shape
    void make();
    void upload(const SmokeEye& eye);

    filament::Engine& engine_;
    filament::Scene& scene_;
    MaterialPool& pool_;
    DepthPass depth_;
    Smoke smoke_;
    std::vector<Float3> shone_; ///< [lx], light that each puff scatters, before exposure
    SmokeLight lamp_;           ///< the strongest spot or point light, which glares in haze
    std::unique_ptr<DrawnPicture> picture_;
    filament::Scene* air_ = nullptr; ///< holds the puffs
    filament::View* view_ = nullptr;
    filament::VertexBuffer *corners_ = nullptr, *screen_ = nullptr;
    filament::IndexBuffer *indices_ = nullptr, *triangle_ = nullptr;
    filament::MaterialInstance *puffs_ = nullptr, *over_ = nullptr;
    utils::Entity cloud_, cover_;
    bool shown_ = false;
};

} // namespace filasofia::visual
