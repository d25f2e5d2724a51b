#include "filasofia/visual/filament_backend.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/visual/egl_platform.h"
#include "filasofia/visual/filament_view.h"
#include "filasofia/visual/gpu.h"
#include "filasofia/visual/pose_matrix.h"
#include "filasofia/visual/quiet_output.h"
#include "filasofia/visual/x11_check.h"

#include <filament/TransformManager.h>
#include <utils/EntityManager.h>

namespace filasofia::visual {

FilamentBackend::FilamentBackend(const VisualServerDef& def)
    : headless_(def.backend == Backend::Headless), width_(def.width), height_(def.height),
      nativeWindow_(def.nativeWindow)
{
    start(def);
}

FilamentBackend::~FilamentBackend() { stop(); }

void FilamentBackend::start(const VisualServerDef& def)
{
    // Filament ends the process when it finds no display or no context: ask before.
    prepareMesa();
    if (headless_) {
        const GpuReport gpu = probeGpu();
        if (!gpu.available) fail("visual server: cannot draw without a screen: ", gpu.problem);
        platform_ = std::make_unique<EglPlatform>();
    } else {
        checkX11Window(def.nativeWindow);
    }
    {
        const QuietOutput quiet;
        engine_ = filament::Engine::create(filament::Engine::Backend::OPENGL, platform_.get());
    }
    if (!engine_) fail("visual server: Filament's OpenGL engine does not start");
    pool_ = std::make_unique<MaterialPool>(*engine_);
    renderer_ = engine_->createRenderer();
    filament::Renderer::DisplayInfo display;
    display.refreshRate = 0.0F; // unknown: then Filament does not pace frames, which the caller does
    renderer_->setDisplayInfo(display);
    filament::Renderer::ClearOptions clear;
    clear.clear = true; // the default leaves the last frame's pixels where there is no view
    clear.clearColor = {0.0F, 0.0F, 0.0F, 1.0F};
    renderer_->setClearOptions(clear);
    scene_ = engine_->createScene();
    grading_ = filament::ColorGrading::Builder()
                   .toneMapping(filament::ColorGrading::ToneMapping::ACES)
                   .contrast(1.05F)
                   .build(*engine_);
    overlays_ = std::make_unique<FilamentOverlays>(*engine_, *renderer_, *scene_, *pool_);
    resize(def.width, def.height);
}

void FilamentBackend::stop()
{
    overlays_.reset();
    for (auto& [slot, each] : views_) engine_->destroy(each.view);
    for (auto& [slot, each] : cameras_) destroyPlace(each.entity);
    for (auto& [slot, entity] : lights_) destroyPlace(entity);
    bodies_.clear();
    pool_.reset(); // after the last instance, before the engine
    destroyEnvironment();
    engine_->destroy(grading_);
    engine_->destroy(scene_);
    engine_->destroy(renderer_);
    engine_->destroy(swapChain_);
    filament::Engine::destroy(&engine_);
}

utils::Entity FilamentBackend::makePlace()
{
    const utils::Entity entity = utils::EntityManager::get().create();
    engine_->getTransformManager().create(entity);
    return entity;
}

void FilamentBackend::destroyPlace(utils::Entity entity)
{
    scene_->remove(entity);
    engine_->destroyCameraComponent(entity);
    engine_->destroy(entity);
    utils::EntityManager::get().destroy(entity);
}

void FilamentBackend::addBody(Slot slot, const Material& material, bool castShadows, BodyGeometry geometry)
{
    bodies_[slot] =
        std::make_unique<FilamentBody>(*engine_, *scene_, *pool_, material, castShadows, std::move(geometry));
}

void FilamentBackend::setGeometry(Slot body, BodyGeometry geometry)
{
    bodies_.at(body)->setGeometry(std::move(geometry));
}
void FilamentBackend::setVertices(Slot body, VertexData vertices)
{
    bodies_.at(body)->setVertices(std::move(vertices));
}
void FilamentBackend::setSurfaceState(Slot body, std::vector<PackedState> states)
{
    bodies_.at(body)->setSurfaceState(std::move(states));
}
void FilamentBackend::setMaterial(Slot body, const Material& material) { bodies_.at(body)->setMaterial(material); }
void FilamentBackend::setVisible(Slot body, bool visible) { bodies_.at(body)->setVisible(visible); }

void FilamentBackend::putCamera(Slot slot, const CameraDef& def)
{
    PlacedCamera& placed = cameras_[slot];
    if (!placed.camera) {
        placed.entity = utils::EntityManager::get().create();
        placed.camera = engine_->createCamera(placed.entity); // makes the transform too
    }
    placed.def = def;
    // Aperture f/1 and ISO 100: the shutter alone is the exposure value. (In 1.9.25 setExposure(float) inverts its
    // number.)
    placed.camera->setExposure(1.0F, static_cast<float>(std::exp2(-def.exposure)), 100.0F);
}

void FilamentBackend::putView(Slot slot, const ViewDef& def, Slot camera)
{
    PlacedView& placed = views_[slot];
    if (!placed.view) {
        placed.view = engine_->createView();
        placed.view->setScene(scene_);
        placed.view->setColorGrading(grading_);
    }
    placed.def = def;
    placed.camera = camera;
    placed.view->setCamera(cameras_.at(camera).camera);
    applyQuality(*placed.view, def.quality, def.occlusionRadius);
}

void FilamentBackend::setPose(Slot entity, const Pose& world)
{
    utils::Entity placed;
    if (const auto body = bodies_.find(entity); body != bodies_.end()) {
        placed = body->second->entity();
    } else if (const auto light = lights_.find(entity); light != lights_.end()) {
        placed = light->second;
    } else {
        placed = cameras_.at(entity).entity;
    }
    auto& transforms = engine_->getTransformManager();
    transforms.setTransform(transforms.getInstance(placed), matrixOf(world));
}

void FilamentBackend::remove(Slot entity)
{
    if (bodies_.erase(entity) > 0) return;
    if (const auto light = lights_.find(entity); light != lights_.end()) {
        destroyPlace(light->second);
        lights_.erase(light);
    } else if (const auto view = views_.find(entity); view != views_.end()) {
        engine_->destroy(view->second.view);
        views_.erase(view);
    } else {
        destroyPlace(cameras_.at(entity).entity);
        cameras_.erase(entity);
    }
}

void FilamentBackend::resize(int width, int height)
{
    width_ = width;
    height_ = height;
    if (swapChain_ && !headless_) return; // a window's swap chain follows the window
    if (swapChain_) {
        engine_->destroy(swapChain_);
        engine_->flushAndWait(); // before its successor is made current
    }
    const std::uint64_t readable = filament::SwapChain::CONFIG_READABLE;
    swapChain_ = headless_ ? engine_->createSwapChain(std::uint32_t(width), std::uint32_t(height), readable)
                           : engine_->createSwapChain(nativeWindow_, readable);
}

bool FilamentBackend::beginFrame(int tries)
{
    for (int i = 0; i < tries; ++i) {
        if (renderer_->beginFrame(swapChain_)) return true;
        if (i + 1 < tries) engine_->flushAndWait(); // the queue of frames is full: let it run empty
    }
    return false;
}

void FilamentBackend::drawViews()
{
    overlays_->drawCanvases();
    for (auto& [slot, each] : views_) {
        const filament::Viewport pixels = pixelsOf(each.def.viewport, width_, height_);
        const PlacedCamera& placed = cameras_.at(each.camera);
        constexpr double kDegree = 3.14159265358979323846 / 180.0;
        // Two views of different shape may share a camera: the projection is the view's.
        placed.camera->setProjection(placed.def.verticalFieldOfView / kDegree,
                                     double(pixels.width) / double(pixels.height), placed.def.near, placed.def.far,
                                     filament::Camera::Fov::VERTICAL);
        each.view->setViewport(pixels);
        each.view->setDynamicLightingOptions(float(4.0 * placed.def.near), float(placed.def.far));
        renderer_->render(each.view);
    }
    overlays_->drawGuis(width_, height_);
}

bool FilamentBackend::draw()
{
    if (!beginFrame(1)) return false;
    drawViews();
    renderer_->endFrame();
    if (headless_) engine_->flushAndWait(); // nobody waits for a screen: frames would pile up
    return true;
}

Image FilamentBackend::capture()
{
    if (!beginFrame(100)) fail("visual server: Filament begins no frame to capture");
    drawViews();
    Image image{width_, height_, std::vector<std::uint8_t>(4 * std::size_t(width_) * std::size_t(height_))};
    bool done = false;
    using filament::backend::PixelBufferDescriptor;
    renderer_->readPixels(0, 0, std::uint32_t(width_), std::uint32_t(height_),
                          PixelBufferDescriptor(
                              image.rgba.data(), image.rgba.size(), filament::backend::PixelDataFormat::RGBA,
                              filament::backend::PixelDataType::UBYTE,
                              [](void*, std::size_t, void* user) { *static_cast<bool*>(user) = true; }, &done));
    renderer_->endFrame();
    // The callback comes when Filament next looks at what has finished. It must come before `image` goes.
    for (int i = 0; i < 1000 && !done; ++i) engine_->flushAndWait();
    FILASOFIA_ASSERT(done);
    return image;
}

} // namespace filasofia::visual
