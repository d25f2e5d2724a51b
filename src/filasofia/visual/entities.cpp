// Lights, cameras and views: their checks and changes.
#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/visual/scene.h"

#include <algorithm>

namespace filasofia::visual {
namespace {

// Filament 1.9 has two shadow maps for spot lights, none for point lights, and one directional light.
constexpr int kShadowSpots = 2;

bool isShadowSpot(const LightDef& def) { return def.castShadows && std::holds_alternative<SpotLight>(def.kind); }
bool isOffScreen(const ViewDef& def) { return std::holds_alternative<OffScreen>(def.target); }
bool isDirectional(const LightDef& def) { return std::holds_alternative<DirectionalLight>(def.kind); }

} // namespace

void sendPlaces(Scene& scene)
{
    RenderBackend& backend = *scene.backend;
    for (VisualBody* body : scene.bodies) {
        backend.setScale(body->impl().slot, body->worldScale());
        backend.setPose(body->impl().slot, body->worldPose());
        backend.setVisible(body->impl().slot, body->worldVisible());
    }
    for (Light* light : scene.lights) {
        backend.setPose(light->impl().slot, light->worldPose());
        backend.setVisible(light->impl().slot, light->worldVisible());
    }
    for (Camera* camera : scene.cameras) backend.setPose(camera->impl().slot, camera->worldPose());
}

void check(const LightDef& def, const Scene& scene, const LightDef* replaced)
{
    const std::string name = text("light '", def.name, "'");
    validate(def, name);
    if (const auto* spot = std::get_if<SpotLight>(&def.kind); spot && spot->innerAngle > spot->outerAngle)
        fail(name, ": kind.innerAngle must be <= outerAngle ", spot->outerAngle, " rad, got ", spot->innerAngle);
    const auto others = [&](auto&& is) {
        return std::count_if(scene.lights.begin(), scene.lights.end(),
                             [&](const Light* other) { return &other->def() != replaced && is(other->def()); });
    };
    if (isShadowSpot(def) && others(isShadowSpot) >= kShadowSpots)
        fail(name, ": castShadows: a scene has at most ", kShadowSpots, " spot lights with shadows");
    if (isDirectional(def) && others(isDirectional) > 0) fail(name, ": a scene has at most one directional light");
}

void check(const CameraDef& def)
{
    const std::string name = text("camera '", def.name, "'");
    validate(def, name);
    if (!(def.far > def.near)) fail(name, ": far must be > near ", def.near, " m, got ", def.far);
}

void check(const ViewDef& def, const Scene& scene, const ViewDef* replaced)
{
    const std::string name = text("view '", def.name, "'");
    validate(def, name);
    const Viewport& port = def.viewport;
    constexpr double kRounding = 1e-9; // so that a third and two thirds fill the window
    if (port.left + port.width > 1.0 + kRounding)
        fail(name, ": viewport.left + width must be <= 1, got ", port.left + port.width);
    if (port.top + port.height > 1.0 + kRounding)
        fail(name, ": viewport.top + height must be <= 1, got ", port.top + port.height);
    if (!isOffScreen(def)) return;
    if (port != Viewport{}) fail(name, ": viewport must be the whole picture for an off-screen view");
    for (const View* other : scene.views)
        if (&other->def() != replaced && isOffScreen(other->def()) && other->def().name == def.name)
            fail(name, ": an off-screen view of this name already exists");
}

void check(const EnvironmentDef& def)
{
    validate(def, "environment");
    if (def.lampDirection == Vec3{}) fail("environment: lampDirection must not be zero");
}

Light::Light(std::string name, std::unique_ptr<Impl> impl) : Transform(std::move(name)), impl_(std::move(impl))
{
    impl_->scene.lights.push_back(this);
}
Light::~Light() { std::erase(impl_->scene.lights, this); }
const LightDef& Light::def() const { return impl_->def; }

void Light::set(const LightDef& def)
{
    impl_->scene.assertThread();
    check(def, impl_->scene, &impl_->def);
    impl_->scene.backend->putLight(impl_->slot, def);
    impl_->def = def;
}

Camera::Camera(std::string name, std::unique_ptr<Impl> impl) : Transform(std::move(name)), impl_(std::move(impl))
{
    impl_->scene.cameras.push_back(this);
}
Camera::~Camera() { std::erase(impl_->scene.cameras, this); }
const CameraDef& Camera::def() const { return impl_->def; }

void Camera::set(const CameraDef& def)
{
    impl_->scene.assertThread();
    check(def);
    impl_->scene.backend->putCamera(impl_->slot, def);
    impl_->def = def;
}

View::View(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) { impl_->scene.views.push_back(this); }
View::~View() { std::erase(impl_->scene.views, this); }
const ViewDef& View::def() const { return impl_->def; }
Camera& View::camera() const { return *impl_->camera; }

void View::set(const ViewDef& def)
{
    impl_->scene.assertThread();
    check(def, impl_->scene, &impl_->def);
    impl_->scene.backend->putView(impl_->slot, def, impl_->camera->impl().slot);
    impl_->def = def;
    refreshViewPictures(impl_->scene);
}

bool View::visible() const { return impl_->visible; }

void View::setVisible(bool visible)
{
    impl_->scene.assertThread();
    impl_->visible = visible;
    impl_->scene.backend->setVisible(impl_->slot, visible);
}

void View::requireOffScreen(const char* instead) const
{
    if (!isOffScreen(impl_->def))
        fail("view '", impl_->def.name,
             "': is in the window and has no picture of its own; use VisualServer::", instead, "()");
}

Image View::capture()
{
    impl_->scene.assertThread();
    requireOffScreen("capture");
    sendPlaces(impl_->scene);
    return impl_->scene.backend->capture(impl_->slot);
}

DepthImage View::captureDepth()
{
    impl_->scene.assertThread();
    requireOffScreen("captureDepth");
    sendPlaces(impl_->scene);
    return impl_->scene.backend->captureDepth(impl_->slot);
}

void View::setCamera(Camera& camera)
{
    impl_->scene.assertThread();
    if (&camera.impl().scene != &impl_->scene)
        fail("view '", impl_->def.name, "': camera '", camera.name(), "' belongs to another server");
    impl_->scene.backend->putView(impl_->slot, impl_->def, camera.impl().slot);
    impl_->camera = &camera;
}

} // namespace filasofia::visual
