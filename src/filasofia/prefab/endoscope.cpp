#include "filasofia/prefab/endoscope.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/math/rounded.h"
#include "filasofia/prefab/lens_soiling.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"
#include "filasofia/runtime/assets.h"

#include <cmath>
#include <tuple>

namespace filasofia::prefab {
namespace {

constexpr Vec3 kSideways = {1.0, 0.0, 0.0};
constexpr Vec3 kBackwards = {0.0, 0.0, 1.0};

std::string hysteroscopeMesh(std::string_view name)
{
    return runtime::asset(text("meshes/hysteroscopy/hysteroscope_", name));
}

EndoscopeDef completed(EndoscopeDef def)
{
    const std::string object = text("endoscope '", def.name, "'");
    validate(def, object);
    def.pose = physics::unitPose(def.pose, text(object, ": pose"));
    def.channel = physics::unitPose(def.channel, text(object, ": channel"));
    if (def.surfaces.empty())
        def.surfaces = {hysteroscopeMesh("sheath.obj"), hysteroscopeMesh("optic.obj"), hysteroscopeMesh("handle.obj")};
    if (const auto* file = std::get_if<std::string>(&def.collision); file && file->empty())
        def.collision = hysteroscopeMesh("collision.obj");
    return def;
}

/// The camera in the tip's coordinates. The identity looks along -Z, the shaft's direction; a rotation by -inclination
/// about +X takes the view towards -Y, and the camera's own roll is about the resulting view.
Pose mounted(const EndoscopeDef& def, double cameraRoll)
{
    return {def.lens, axisAngle(kSideways, -def.inclination) * axisAngle(kBackwards, cameraRoll)};
}

} // namespace

struct Endoscope::Impl {
    Impl(runtime::Simulation& sim, const EndoscopeDef& asked)
        : simulation(sim), def(completed(asked)), aim{def.pose}, newest(aim), body(addBody()),
          soiling(std::make_shared<LensSoiling>(sim, body, kCamera, def.soiling))
    {
        try {
            showSurfaces();
        } catch (...) {
            simulation.physics().remove(body);
            throw;
        }
    }

    void showSurfaces()
    {
        // The scope's surfaces cast no shadow, because its own light is inside them.
        for (const runtime::SurfaceSource& surface : def.surfaces)
            simulation.show(body, {.surface = surface,
                                   .element = kShaft,
                                   .material = visual::MetalMaterial{.roughness = 0.35},
                                   .castShadows = false});
    }

    BodyId addBody()
    {
        physics::RigidBodyDef rigid{.name = def.name, .elements = {tip(aim), camera(aim)}, .friction = def.friction};
        for (const int group : def.groups)
            rigid.collision.push_back(
                {.mesh = def.collision, .element = kShaft, .proximity = def.proximity, .group = group});
        return simulation.add(rigid);
    }

    /// The last commanded pose and rolls.
    struct Aim {
        Pose lastPose = {};
        double rolled = 0.0;
        double cameraRolled = 0.0;
    };
    [[nodiscard]] static Pose tip(const Aim& at) { return at.lastPose * Pose{{}, axisAngle(kBackwards, at.rolled)}; }
    [[nodiscard]] Pose camera(const Aim& at) const { return tip(at) * mounted(def, at.cameraRolled); }

    using Kept = std::tuple<Aim>;
    auto kept() { return std::tie(aim); }
    void publish() { newest.write(aim); }

    /// Any thread. The stepping thread does not wait for others.
    template <class Change> void change(Change by)
    {
        turns.take(!simulation.physics().stepsHere(), [this, by] {
            by(aim);
            publish();
            simulation.physics().setPose(body, rounded(tip(aim)), kShaft);
            simulation.physics().setPose(body, rounded(camera(aim)), kCamera);
        });
    }

    void checkAngle(double angle, std::string_view what) const
    {
        if (!std::isfinite(angle)) fail("endoscope '", def.name, "': ", what, " must be finite, got ", angle, " rad");
    }

    runtime::Simulation& simulation;
    const EndoscopeDef def;
    Turns turns; // guards the members below and the order of commands
    Aim aim;
    Published<Aim> newest; // for all threads
    const BodyId body;     // built from the members above
    const std::shared_ptr<LensSoiling> soiling;
    visual::View* view = nullptr; ///< used by the main thread only
};

Endoscope::Endoscope(runtime::Simulation& simulation, const EndoscopeDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    const std::string object = text("endoscope '", impl_->def.name, "'");
    remember(simulation, object, impl_);
    simulation.everyStep([lens = impl_->soiling](double time) { lens->step(time); });
    remember(simulation, object + ": its lens", impl_->soiling);
    simulation.show(visual::GuiDef{.name = text(def.name, " dirt"), .renderCallback = [weak = std::weak_ptr(impl_)] {
                                       const auto impl = weak.lock();
                                       if (impl && impl->view != nullptr)
                                           impl->soiling->draw(*impl->view, impl->def.optics);
                                   }});
}
Endoscope::~Endoscope() = default;

BodyId Endoscope::body() const { return impl_->body; }

void Endoscope::move(const Pose& tip)
{
    const Pose unit = physics::unitPose(tip, text("endoscope '", impl_->def.name, "'"));
    impl_->change([unit](Impl::Aim& aim) { aim.lastPose = unit; });
}

void Endoscope::roll(double angle)
{
    impl_->checkAngle(angle, "roll");
    impl_->change([angle](Impl::Aim& aim) { aim.rolled = angle; });
}

void Endoscope::cameraRoll(double angle)
{
    impl_->checkAngle(angle, "cameraRoll");
    impl_->change([angle](Impl::Aim& aim) { aim.cameraRolled = angle; });
}

Pose Endoscope::tip() const { return Impl::tip(impl_->newest.read()); }
Pose Endoscope::camera() const { return impl_->camera(impl_->newest.read()); }

Pose Endoscope::channel() const { return tip() * impl_->def.channel; }

void Endoscope::soil(const LensState& lens) { impl_->soiling->set(lens); }
LensState Endoscope::lens() const { return impl_->soiling->now(); }

EndoscopeView Endoscope::dress(visual::VisualServer& server)
{
    const EndoscopeDef& def = impl_->def;
    EndoscopeView out;
    out.camera = &server.add(visual::CameraDef{.name = text(def.name, " camera"),
                                               .verticalFieldOfView = def.fieldOfView,
                                               .near = 0.2e-3,
                                               .far = 0.5,
                                               .focusDistance = def.focusDistance});
    impl_->simulation.follow(*out.camera, impl_->body, {.at = runtime::FollowElement{kCamera}});

    // A ring of fibres around the lens shines wider than the picture. Beside the lens it gives the lit tissue shading.
    const visual::SpotLight spot{.intensity = def.intensity,
                                 .innerAngle = 0.15,
                                 .outerAngle = std::min(1.4, 0.75 * def.fieldOfView),
                                 .range = 0.3};
    out.light = &server.add(visual::LightDef{.name = text(def.name, " light"), .kind = spot, .color = def.lightColor});
    Pose lamp = mounted(def, 0.0);
    lamp.position += def.lamp;
    impl_->simulation.follow(*out.light, impl_->body, {.at = runtime::FollowElement{kShaft}, .offset = lamp});

    server.setEnvironment(def.surroundings);

    visual::Effects effects = visual::effectsOf(def.quality, 2e-3);
    effects.endoscope = def.optics;
    effects.vignette = {}; // the optics have their own
    out.view = &server.add(visual::ViewDef{.name = text(def.name, " view"), .quality = def.quality, .effects = effects},
                           *out.camera);
    impl_->view = out.view;
    return out;
}

} // namespace filasofia::prefab
