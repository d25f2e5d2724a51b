#include "filasofia/prefab/laparoscope.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/trocar_drive.h"
#include "filasofia/runtime/assets.h"

#include <atomic>
#include <cmath>

namespace filasofia::prefab {
namespace {

constexpr double kMostZoom = 4.0;
constexpr double kWithdrawn = 5e-3; ///< [m], insertion beyond the least at which a lens is wiped

std::string objectOf(const LaparoscopeDef& def) { return text("laparoscope '", def.name, "'"); }

LaparoscopeDef checked(const LaparoscopeDef& def)
{
    validate(def, objectOf(def));
    return def;
}

EndoscopeDef endoscopeOf(const LaparoscopeDef& def)
{
    return {.name = def.name,
            .pose = pivotOf(def.trocar, def.start),
            .surfaces = {runtime::asset("meshes/laparoscopy/laparoscope.obj")},
            .collision = runtime::asset("meshes/laparoscopy/laparoscope_collision.obj"),
            .groups = def.groups,
            .lens = {0.0, 0.0, -0.5e-3}, // before the glass, so that the shaft is in no picture
            .inclination = def.inclination,
            .fieldOfView = def.fieldOfView,
            .intensity = def.intensity,
            .lamp = {3e-3, 2e-3, 0.0},
            .optics = def.optics,
            .quality = def.quality,
            .focusDistance = 0.1,
            .surroundings = def.surroundings,
            .soiling = def.soiling};
}

} // namespace

struct Laparoscope::Impl {
    Impl(runtime::Simulation& sim, const LaparoscopeDef& asked)
        : def(checked(asked)), drive(sim, {objectOf(asked), asked.trocar, asked.hand, asked.start}),
          scope(sim, endoscopeOf(def)), times(def.zoom), upright(def.horizon)
    {
        level(drive.report().pivot);
    }
    [[nodiscard]] BodyId body() const { return scope.body(); }
    [[nodiscard]] static Vec3 grip() { return {}; } // it holds nothing
    void go(const Pose& tip)
    {
        if (def.soiling && drive.report().pose.insertion < def.trocar.leastInsertion + kWithdrawn) scope.wipe();
        scope.move(tip);
        level(tip);
    }

    /// Turns the camera head so that the picture's upper side is as near to `up` as the view allows. If the view goes
    /// along it, the head stays as it is.
    void level(const Pose& tip)
    {
        if (!upright) return scope.cameraRoll(0.0);
        const Quat straight = tip.orientation * axisAngle({1.0, 0.0, 0.0}, -def.inclination);
        const Vec3 up = rotate(conjugate(straight), normalized(def.trocar.up));
        if (std::hypot(up.x, up.y) > 1e-3) scope.cameraRoll(std::atan2(-up.x, up.y));
    }
    [[nodiscard]] double fieldOfView() const { return 2.0 * std::atan(std::tan(0.5 * def.fieldOfView) / times); }

    /// On the main thread, before every picture. If a picture has a lens of its own, that stays, and the zoom waits.
    void setLens()
    {
        if (view.camera == nullptr || view.camera->def().verticalFieldOfView != lensSet) return;
        turnLens();
    }
    void turnLens()
    {
        lensSet = fieldOfView();
        visual::CameraDef lens = view.camera->def();
        if (lens.verticalFieldOfView == lensSet) return;
        lens.verticalFieldOfView = lensSet;
        view.camera->set(lens);
    }

    const LaparoscopeDef def;
    TrocarDrive drive;
    Endoscope scope;
    EndoscopeView view;   ///< used by the main thread only
    double lensSet = 0.0; ///< [rad] the angle that the camera was last given; used by the main thread only
    std::atomic<double> times;
    std::atomic<bool> upright;
};

Laparoscope::Laparoscope(runtime::Simulation& simulation, const LaparoscopeDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    driveEveryStep(simulation, impl_);
    remember(simulation, objectOf(def) + " in its trocar", std::shared_ptr<TrocarDrive>(impl_, &impl_->drive));
    simulation.show(visual::GuiDef{.name = text(def.name, " lens"), .renderCallback = [weak = std::weak_ptr(impl_)] {
                                       if (const auto impl = weak.lock()) impl->setLens();
                                   }});
}
Laparoscope::~Laparoscope() = default;

BodyId Laparoscope::body() const { return impl_->body(); }
const LaparoscopeDef& Laparoscope::def() const { return impl_->def; }
void Laparoscope::move(const TrocarPose& pose) { impl_->drive.move(pose); }
void Laparoscope::zoom(double times)
{
    if (!(times >= 1.0 && times <= kMostZoom))
        fail(objectOf(impl_->def), ": zoom must be in [1, ", kMostZoom, "], got ", times);
    impl_->times = times;
}
void Laparoscope::soil(const LensState& lens) { impl_->scope.soil(lens); }
LensState Laparoscope::lens() const { return impl_->scope.lens(); }
void Laparoscope::horizon(bool keep) { impl_->upright = keep; }
TrocarReport Laparoscope::report() const { return impl_->drive.report(); }
Pose Laparoscope::camera() const { return impl_->scope.camera(); }
double Laparoscope::fieldOfView() const { return impl_->fieldOfView(); }
BodyId Laparoscope::handle() const { return impl_->drive.handle(); }

EndoscopeView Laparoscope::dress(visual::VisualServer& server)
{
    impl_->view = impl_->scope.dress(server);
    impl_->turnLens();
    return impl_->view;
}

} // namespace filasofia::prefab
