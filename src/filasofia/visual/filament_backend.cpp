#include "filasofia/visual/filament_backend.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/depth_views.h"
#include "filasofia/visual/egl_platform.h"
#include "filasofia/visual/filament_read.h"
#include "filasofia/visual/filament_view.h"
#include "filasofia/visual/gpu.h"
#include "filasofia/visual/pixel_area.h"
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
    // Filament ends the process if it finds no display or no context, so we check first.
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
    display.refreshRate = 0.0F; // unknown, so that Filament does not pace frames; the caller does
    renderer_->setDisplayInfo(display);
    renderer_->setClearOptions(clearTo(1.0F)); // the default leaves the last frame's pixels where there is no view
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
    depth_.reset();
    smoke_.reset();
    for (auto& [slot, each] : views_) destroyView(each);
    for (auto& [slot, each] : cameras_) destroyPlace(each.entity);
    for (auto& [slot, each] : lights_) destroyPlace(each.entity);
    bodies_.clear();
    if (blank_) {
        engine_->destroy(blank_);
        engine_->destroy(nothing_);
        destroyPlace(nobody_);
    }
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

void FilamentBackend::addBody(Slot slot, const ReadyMaterial& material, const BodyTraits& traits, BodyGeometry geometry)
{
    countHandles();
    bodies_[slot] = std::make_unique<FilamentBody>(*engine_, *scene_, *pool_, material, traits, std::move(geometry));
}

void FilamentBackend::setGeometry(Slot body, BodyGeometry geometry)
{
    countHandles();
    bodies_.at(body)->setGeometry(std::move(geometry));
}

void FilamentBackend::countHandles()
{
    constexpr int kOften = 128;
    if (++handlesTaken_ < kOften) return;
    handlesTaken_ = 0;
    engine_->flushAndWait();
}
void FilamentBackend::setVertices(Slot body, VertexData vertices)
{
    bodies_.at(body)->setVertices(std::move(vertices));
}
void FilamentBackend::setSurfaceState(Slot body, std::vector<PackedState> states)
{
    bodies_.at(body)->setSurfaceState(std::move(states));
}
void FilamentBackend::setMaterial(Slot body, const ReadyMaterial& material)
{
    if (bodies_.at(body)->setMaterial(material)) countHandles();
}

void FilamentBackend::putCamera(Slot slot, const CameraDef& def)
{
    PlacedCamera& placed = cameras_[slot];
    if (!placed.camera) {
        placed.entity = utils::EntityManager::get().create();
        placed.camera = engine_->createCamera(placed.entity); // makes the transform too
    }
    placed.def = def;
    placed.blurScale = exposeCamera(*placed.camera, def);
    for (auto& [view, each] : views_)
        if (each.camera == slot) applyView(each);
}

void FilamentBackend::putView(Slot slot, const ViewDef& def, Slot camera)
{
    countHandles();
    PlacedView& placed = views_[slot];
    if (!placed.view) {
        placed.view = engine_->createView();
        placed.view->setScene(scene_);
        placed.view->setColorGrading(grading_);
    }
    if (placed.picture) pool_->textures().setView(placed.def.name, nullptr);
    placed.def = def;
    placed.camera = camera;
    placed.view->setCamera(cameras_.at(camera).camera);
    applyView(placed);
    const auto* size = std::get_if<OffScreen>(&def.target);
    if (!size) {
        placed.picture.reset();
        return;
    }
    if (!placed.picture || placed.picture->width() != size->width || placed.picture->height() != size->height)
        placed.picture = std::make_unique<DrawnPicture>(*engine_, size->width, size->height);
    pool_->textures().setView(def.name, placed.picture->texture());
}

void FilamentBackend::applyView(PlacedView& placed)
{
    const Effects effects = placed.def.effects.value_or(effectsOf(placed.def.quality, placed.def.occlusionRadius));
    applyEffects(*placed.view, effects, cameras_.at(placed.camera).blurScale);
    if (!effects.endoscope)
        placed.optics.reset();
    else if (!placed.optics)
        placed.optics = std::make_unique<OpticsPass>(*engine_, *pool_);
}

void FilamentBackend::destroyView(PlacedView& placed)
{
    if (placed.picture) pool_->textures().setView(placed.def.name, nullptr);
    engine_->destroy(placed.view);
    placed.optics.reset();
    placed.picture.reset();
}

void FilamentBackend::setPose(Slot entity, const Pose& world)
{
    utils::Entity placed;
    double scale = 1.0; // lights and cameras have no size
    if (const auto body = bodies_.find(entity); body != bodies_.end()) {
        placed = body->second->entity();
        scale = body->second->scale();
    } else if (const auto light = lights_.find(entity); light != lights_.end()) {
        placed = light->second.entity;
        light->second.seen.pose = world;
    } else {
        PlacedCamera& camera = cameras_.at(entity);
        placed = camera.entity;
        camera.pose = world;
    }
    auto& transforms = engine_->getTransformManager();
    transforms.setTransform(transforms.getInstance(placed), matrixOf(world, scale));
}

void FilamentBackend::setScale(Slot body, double scale) { bodies_.at(body)->setScale(scale); }

void FilamentBackend::setVisible(Slot entity, bool visible)
{
    if (const auto body = bodies_.find(entity); body != bodies_.end()) {
        body->second->setVisible(visible);
    } else if (const auto view = views_.find(entity); view != views_.end()) {
        view->second.visible = visible;
    } else {
        PlacedLight& light = lights_.at(entity);
        light.seen.visible = visible;
        if (visible != scene_->hasEntity(light.entity))
            visible ? scene_->addEntity(light.entity) : scene_->remove(light.entity);
    }
}

void FilamentBackend::remove(Slot entity)
{
    if (bodies_.erase(entity) > 0) return;
    if (const auto light = lights_.find(entity); light != lights_.end()) {
        destroyPlace(light->second.entity);
        lights_.erase(light);
    } else if (const auto view = views_.find(entity); view != views_.end()) {
        destroyView(view->second);
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
    prepareOptics();
    lightSmoke();
    for (int i = 0; i < tries; ++i) {
        if (renderer_->beginFrame(swapChain_)) return true;
        if (i + 1 < tries) engine_->flushAndWait(); // the queue of frames is full: wait until it is empty
    }
    return false;
}

filament::Viewport FilamentBackend::pixelsOfView(const PlacedView& view) const
{
    return view.picture ? pixelsOf({}, view.picture->width(), view.picture->height())
                        : pixelsOf(view.def.viewport, width_, height_);
}

void FilamentBackend::prepareOptics()
{
    // Material parameters reach the card at beginFrame; if they are set later, they come a frame late.
    for (auto& [slot, each] : views_) {
        if (!each.optics) continue;
        const filament::Viewport pixels = pixelsOfView(each);
        each.optics->prepare(int(pixels.width), int(pixels.height), *each.def.effects->endoscope);
    }
}

void FilamentBackend::project(PlacedView& view, const filament::Viewport& pixels)
{
    const PlacedCamera& placed = cameras_.at(view.camera);
    constexpr double kDegree = 3.14159265358979323846 / 180.0;
    placed.camera->setProjection(placed.def.verticalFieldOfView / kDegree, double(pixels.width) / double(pixels.height),
                                 placed.def.near, placed.def.far, filament::Camera::Fov::VERTICAL);
}

template <class Render> void FilamentBackend::drawView(PlacedView& each, Render&& render)
{
    const filament::Viewport pixels = pixelsOfView(each);
    filament::RenderTarget* const target = each.picture ? each.picture->target() : nullptr;
    project(each, pixels);
    const CameraDef& eye = cameras_.at(each.camera).def;
    each.view->setDynamicLightingOptions(float(4.0 * eye.near), float(eye.far));
    if (smoke_ && !smoke_->empty()) {
        const PlacedCamera& placed = cameras_.at(each.camera);
        renderer_->setClearOptions(clearTo(0.0F)); // the picture of the smoke is transparent where there is none
        smoke_->draw(render, {placed.camera, placed.pose, eye, double(pixels.width) / double(pixels.height)}, bodies_);
        renderer_->setClearOptions(clearTo(1.0F));
    }
    each.view->setViewport(pixels);
    each.view->setRenderTarget(target);
    if (!each.optics) {
        render(each.view);
        return;
    }
    each.view->setViewport({0, 0, pixels.width, pixels.height});
    each.view->setRenderTarget(each.optics->picture().target());
    render(each.view);
    filament::View& lens = each.optics->view();
    lens.setViewport(pixels);
    lens.setRenderTarget(target);
    render(&lens);
}

void FilamentBackend::drawViews()
{
    overlays_->drawCanvases();
    bool seen = false;
    for (const bool offScreen : {true, false})
        for (auto& [slot, each] : views_)
            if (each.visible && bool(each.picture) == offScreen) {
                drawView(each, [&](filament::View* view) { renderer_->render(view); });
                seen = seen || !offScreen;
            }
    if (!seen) clearWindow();
    overlays_->drawGuis(width_, height_);
}

void FilamentBackend::clearWindow()
{
    if (!blank_) {
        nothing_ = engine_->createScene();
        nobody_ = utils::EntityManager::get().create();
        blank_ = engine_->createView();
        blank_->setScene(nothing_);
        blank_->setCamera(engine_->createCamera(nobody_));
        blank_->setPostProcessingEnabled(false);
    }
    blank_->setViewport({0, 0, std::uint32_t(width_), std::uint32_t(height_)});
    renderer_->render(blank_);
}

bool FilamentBackend::draw()
{
    if (!beginFrame(1)) return false;
    drawViews();
    renderer_->endFrame();
    if (headless_) engine_->flushAndWait(); // no screen limits the rate, so frames would pile up
    return true;
}

Image FilamentBackend::capture()
{
    if (!beginFrame(100)) fail("visual server: Filament did not begin a frame to capture");
    drawViews();
    return read(nullptr, width_, height_, true);
}

Image FilamentBackend::capture(Slot asked)
{
    prepareOptics();
    lightSmoke();
    for (auto& [slot, each] : views_)
        if (each.picture && slot <= asked && (each.visible || slot == asked))
            drawView(each, [&](filament::View* view) { renderer_->renderStandaloneView(view); });
    const DrawnPicture& picture = *views_.at(asked).picture;
    return read(picture.target(), picture.width(), picture.height(), false);
}

Image FilamentBackend::read(filament::RenderTarget* target, int width, int height, bool endsFrame)
{
    Image image{width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height))};
    readPixels(*engine_, *renderer_, target, width, height, endsFrame, {image.rgba.data(), image.rgba.size()});
    return image;
}

DepthImage FilamentBackend::captureDepth()
{
    DepthImage window = emptyDepth(width_, height_);
    for (auto& [slot, each] : views_) {
        if (!each.visible || each.picture) continue;
        const PixelArea area = pixelArea(each.def.viewport, width_, height_);
        place(drawDepth(each), area.left, area.top, window);
    }
    return window;
}

DepthImage FilamentBackend::captureDepth(Slot view) { return drawDepth(views_.at(view)); }

DepthImage FilamentBackend::drawDepth(PlacedView& view)
{
    if (!depth_) depth_ = std::make_unique<DepthPass>(*engine_, *pool_);
    const filament::Viewport pixels = pixelsOfView(view);
    project(view, pixels);
    const DepthImage image =
        depth_->draw(*renderer_, *cameras_.at(view.camera).camera, bodies_, int(pixels.width), int(pixels.height));
    return view.optics ? throughLens(image, *view.def.effects->endoscope) : image;
}

} // namespace filasofia::visual
