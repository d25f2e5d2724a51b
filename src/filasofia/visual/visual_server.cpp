#include "filasofia/visual/visual_server.h"

#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/native.h"
#include "filasofia/visual/overlays.h"
#include "filasofia/visual/scene.h"

#include <algorithm>
#include <chrono>

namespace filasofia::visual {
namespace {

/// The time [s] that `work` took.
template <class Work> double secondsOf(Work&& work)
{
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

struct VisualServer::Impl {
    int width = 0;
    int height = 0;
    Scene scene;
    EnvironmentDef environment;
    std::vector<std::unique_ptr<VisualBody>> bodies;
    std::vector<std::unique_ptr<Light>> lights;
    std::vector<std::unique_ptr<Camera>> cameras;
    std::vector<std::unique_ptr<View>> views;
    std::vector<std::unique_ptr<Transform>> rigs;
    Slot lastSlot = 0;
    VisualStatistics statistics;
    Overlays overlays;  ///< after the views that Guis lie on, so that it is destroyed first
    bool paced = false; ///< somebody watches the frames in real time
    std::chrono::steady_clock::time_point lastFrame = std::chrono::steady_clock::now();

    /// The place of an entity in a list, or its end.
    template <class List, class Wanted> static auto find(List& list, Wanted& wanted)
    {
        return std::find_if(list.begin(), list.end(), [&](const auto& each) { return each.get() == &wanted; });
    }

    /// Removes `entity` from scene and list; returns false if it is not in this list.
    template <class Entity> bool erase(std::vector<std::unique_ptr<Entity>>& list, Transform& entity)
    {
        const auto found = find(list, entity);
        if (found == list.end()) return false;
        if constexpr (!std::is_same_v<Entity, Transform>) scene.backend->remove((*found)->impl().slot);
        list.erase(found);
        return true;
    }

    Gui& addGui(const GuiDef& def, View* view)
    {
        return overlays.add(def, view, ++lastSlot, scene.backend->overlays(), width, height);
    }

    /// Guis, Canvases and debug drawings for the next picture. If nobody watches, a second has 60 frames, so that the
    /// same calls give the same pictures.
    void drawOverlays()
    {
        const auto now = std::chrono::steady_clock::now();
        const double passed = std::chrono::duration<double>(now - std::exchange(lastFrame, now)).count();
        OverlayBackend& backend = scene.backend->overlays();
        statistics.lastGuiSeconds =
            secondsOf([&] { overlays.draw(backend, views, width, height, paced ? passed : 1.0 / 60.0); });
    }
};

namespace {

void checkSize(int width, int height)
{
    VisualServerDef def;
    def.width = width;
    def.height = height;
    validate(def, "visual server");
}

} // namespace

VisualServer::VisualServer(const VisualServerDef& def) : impl_(std::make_unique<Impl>())
{
    checkSize(def.width, def.height);
    impl_->width = def.width;
    impl_->height = def.height;
    impl_->paced = def.backend == Backend::Window;
    impl_->scene.backend = makeBackend(def);
    impl_->scene.backend->setEnvironment({});
}

VisualServer::~VisualServer() { impl_->scene.assertThread(); }

VisualBody& VisualServer::add(const VisualBodyDef& def)
{
    impl_->scene.assertThread();
    check(def);
    if (impl_->bodies.size() >= kMaxBodies)
        fail("body '", def.name, "': a server has at most ", kMaxBodies, " bodies at a time");
    Subdivision subdivision(def.mesh, def.subdivision, text("body '", def.name, "'"));
    const ReadyMaterial material = readyMaterial(impl_->scene, def.material, def.mesh, def.name);
    BodyGeometry geometry = bodyGeometry(subdivision, def.mesh.vertices, def.mesh.vertices);
    const Slot slot = ++impl_->lastSlot;
    auto body = std::unique_ptr<VisualBody::Impl>(
        new VisualBody::Impl{impl_->scene, slot, def, std::move(subdivision), material.needsTangents});
    impl_->scene.watch.start();
    if (material.needsTangents) geometry.vertices = body->deform(def.mesh.vertices);
    impl_->scene.backend->addBody(slot, material,
                                  {.castShadows = def.castShadows, .label = static_cast<std::uint32_t>(def.label)},
                                  std::move(geometry));
    ++impl_->scene.vertexUpdates;
    impl_->bodies.push_back(std::make_unique<VisualBody>(def.name, std::move(body)));
    return *impl_->bodies.back();
}

Light& VisualServer::add(const LightDef& def)
{
    impl_->scene.assertThread();
    check(def, impl_->scene, nullptr);
    const Slot slot = ++impl_->lastSlot;
    impl_->scene.backend->putLight(slot, def);
    impl_->lights.push_back(
        std::make_unique<Light>(def.name, std::unique_ptr<Light::Impl>(new Light::Impl{impl_->scene, slot, def})));
    return *impl_->lights.back();
}

Camera& VisualServer::add(const CameraDef& def)
{
    impl_->scene.assertThread();
    check(def);
    const Slot slot = ++impl_->lastSlot;
    impl_->scene.backend->putCamera(slot, def);
    impl_->cameras.push_back(
        std::make_unique<Camera>(def.name, std::unique_ptr<Camera::Impl>(new Camera::Impl{impl_->scene, slot, def})));
    return *impl_->cameras.back();
}

View& VisualServer::add(const ViewDef& def, Camera& camera)
{
    impl_->scene.assertThread();
    check(def, impl_->scene, nullptr);
    if (&camera.impl().scene != &impl_->scene)
        fail("view '", def.name, "': camera '", camera.name(), "' belongs to another server");
    const Slot slot = ++impl_->lastSlot;
    impl_->scene.backend->putView(slot, def, camera.impl().slot);
    impl_->views.push_back(
        std::make_unique<View>(std::unique_ptr<View::Impl>(new View::Impl{impl_->scene, slot, def, &camera})));
    refreshViewPictures(impl_->scene);
    return *impl_->views.back();
}

Gui& VisualServer::add(const GuiDef& def, View& view)
{
    impl_->scene.assertThread();
    if (&view.impl().scene != &impl_->scene)
        fail("gui '", def.name, "': view '", view.def().name, "' belongs to another server");
    return impl_->addGui(def, &view);
}

Gui& VisualServer::add(const GuiDef& def)
{
    impl_->scene.assertThread();
    return impl_->addGui(def, nullptr);
}

Canvas& VisualServer::add(const CanvasDef& def)
{
    impl_->scene.assertThread();
    return impl_->overlays.add(def, ++impl_->lastSlot, impl_->scene.backend->overlays());
}

Transform& VisualServer::addTransform(std::string name)
{
    impl_->scene.assertThread();
    impl_->rigs.push_back(std::make_unique<Transform>(std::move(name)));
    return *impl_->rigs.back();
}

void VisualServer::remove(Transform& entity)
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("remove");
    for (const auto& view : impl_->views)
        if (&view->camera() == &entity)
            fail("camera '", entity.name(), "' cannot be removed: view '", view->def().name, "' shows it");
    if (!impl_->erase(impl_->bodies, entity) && !impl_->erase(impl_->lights, entity) &&
        !impl_->erase(impl_->cameras, entity) && !impl_->erase(impl_->rigs, entity) && !impl_->overlays.remove(entity))
        fail("'", entity.name(), "' cannot be removed: it does not belong to this server");
}

void VisualServer::remove(View& view)
{
    impl_->scene.assertThread();
    const auto found = Impl::find(impl_->views, view);
    if (found == impl_->views.end())
        fail("view '", view.def().name, "' cannot be removed: it does not belong to this server");
    impl_->overlays.checkNotCalled("remove");
    impl_->overlays.checkRemoval(view);
    impl_->scene.backend->remove(view.impl().slot);
    impl_->views.erase(found);
    refreshViewPictures(impl_->scene);
}

void VisualServer::addMaterial(const std::string& name, const Material& material)
{
    impl_->scene.assertThread();
    visual::addMaterial(impl_->scene, name, material);
}

void VisualServer::changeMaterial(const std::string& name, const Material& material)
{
    impl_->scene.assertThread();
    visual::changeMaterial(impl_->scene, name, material);
}

void VisualServer::removeMaterial(const std::string& name)
{
    impl_->scene.assertThread();
    visual::removeMaterial(impl_->scene, name);
}

const Material& VisualServer::material(const std::string& name) const
{
    return impl_->scene.materials.get(name, "visual server");
}

void VisualServer::remove(Gui& gui)
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("remove");
    if (!impl_->overlays.remove(gui))
        fail("gui '", gui.name(), "' cannot be removed: it does not belong to this server");
}

bool VisualServer::handle(const event::Event& event)
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("handle");
    return impl_->overlays.handle(event);
}

bool VisualServer::wantsText() const { return impl_->overlays.wantsText(); }

void VisualServer::setGuiScale(double scale)
{
    impl_->scene.assertThread();
    impl_->overlays.setGuiScale(scale);
}

std::vector<VisualBody*> VisualServer::bodies() const
{
    std::vector<VisualBody*> all;
    for (const auto& body : impl_->bodies) all.push_back(body.get());
    return all;
}

std::vector<Light*> VisualServer::lights() const { return impl_->scene.lights; }
std::vector<Camera*> VisualServer::cameras() const { return impl_->scene.cameras; }
const EnvironmentDef& VisualServer::environment() const { return impl_->environment; }
const std::map<std::string, Material>& VisualServer::materials() const { return impl_->scene.materials.all(); }

std::vector<View*> VisualServer::views() const
{
    std::vector<View*> all;
    for (const auto& view : impl_->views) all.push_back(view.get());
    return all;
}

DebugDraw& VisualServer::debug() { return impl_->overlays.debug(); }

void VisualServer::setEnvironment(const EnvironmentDef& def)
{
    impl_->scene.assertThread();
    check(def);
    impl_->scene.backend->setEnvironment(def);
    impl_->environment = def;
}

void VisualServer::setSmoke(const Smoke& smoke)
{
    impl_->scene.assertThread();
    validate(smoke, "smoke");
    constexpr std::size_t kMost = 256;
    if (smoke.puffs.size() > kMost) fail("smoke: at most ", kMost, " puffs, got ", smoke.puffs.size());
    if (geometry::isEmpty(smoke.room)) fail("smoke: room.high must be >= room.low in every axis");
    impl_->scene.backend->setSmoke(smoke);
}

bool VisualServer::render()
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("render");
    bool drawn = false;
    impl_->scene.watch.start();
    const double seconds = secondsOf([&] {
        impl_->drawOverlays();
        sendPlaces(impl_->scene); // after the callbacks, which may move things
        drawn = impl_->scene.backend->draw();
    });
    impl_->scene.watch.lap(&VisualStages::submit);
    if (drawn) impl_->statistics.lastFrameSeconds = seconds;
    ++(drawn ? impl_->statistics.framesDrawn : impl_->statistics.framesSkipped);
    return drawn;
}

void VisualServer::resize(int width, int height)
{
    impl_->scene.assertThread();
    checkSize(width, height);
    if (width == impl_->width && height == impl_->height) return;
    impl_->scene.backend->resize(width, height);
    impl_->width = width;
    impl_->height = height;
}

int VisualServer::width() const { return impl_->width; }
int VisualServer::height() const { return impl_->height; }

Image VisualServer::capture()
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("capture");
    Image image;
    impl_->statistics.lastFrameSeconds = secondsOf([&] {
        impl_->drawOverlays();
        sendPlaces(impl_->scene);
        image = impl_->scene.backend->capture();
    });
    ++impl_->statistics.framesDrawn;
    return image;
}

DepthImage VisualServer::captureDepth()
{
    impl_->scene.assertThread();
    impl_->overlays.checkNotCalled("captureDepth");
    sendPlaces(impl_->scene);
    return impl_->scene.backend->captureDepth();
}

VisualStatistics VisualServer::statistics() const
{
    VisualStatistics now = impl_->statistics;
    now.vertexUpdates = impl_->scene.vertexUpdates;
    now.bodies = static_cast<int>(impl_->bodies.size());
    now.lights = static_cast<int>(impl_->lights.size());
    now.cameras = static_cast<int>(impl_->cameras.size());
    now.views = static_cast<int>(impl_->views.size());
    now.stages = impl_->scene.watch.sums();
    return now;
}

void VisualServer::timeStages(std::function<double()> now)
{
    impl_->scene.assertThread();
    impl_->scene.watch = StageWatch(std::move(now));
}

bool VisualServer::has(const Transform& entity) const
{
    impl_->scene.assertThread();
    const auto holds = [&](const auto& list) { return Impl::find(list, entity) != list.end(); };
    return holds(impl_->bodies) || holds(impl_->lights) || holds(impl_->cameras) || holds(impl_->rigs) ||
           impl_->overlays.has(entity);
}

namespace native {

filament::Engine* engine(VisualServer& server) { return server.impl().scene.backend->native().engine; }
filament::Renderer* renderer(VisualServer& server) { return server.impl().scene.backend->native().renderer; }
filament::Scene* scene(VisualServer& server) { return server.impl().scene.backend->native().scene; }
filament::View* view(View& view) { return view.impl().scene.backend->nativeView(view.impl().slot); }

} // namespace native
} // namespace filasofia::visual
