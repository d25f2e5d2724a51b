#include "filasofia/prefab/lens_soiling.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::prefab {
namespace {

constexpr double kSmokeLook = 0.05; ///< [s] between two looks at the smoke
constexpr double kBefore = 10e-3;   ///< [m], length of the way along the view on which it is looked at
constexpr double kLevels = 100.0;   ///< [-], levels of the picture: each change is a line of a recording

} // namespace

LensSoiling::LensSoiling(runtime::Simulation& simulation, BodyId scope, int camera, const std::optional<LensDef>& def)
    : simulation_(simulation), scope_(scope), camera_(camera), def_(def)
{
    if (def_) state_.lens.mist = def_->cold;
    publish();
}

void LensSoiling::set(const LensState& lens)
{
    for (const auto& [value, name] : {std::pair(lens.mist, "mist"), std::pair(lens.smear, "smear")})
        if (!(value >= 0.0 && value <= 1.0))
            fail("endoscope '", simulation_.physics().nameOf(scope_), "': ", name, " must be in [0, 1], got ", value);
    const std::lock_guard lock(mutex_);
    asked_ = lens;
}

/// Whether the scope touches a soft body near its lens.
bool LensSoiling::touches(const frame::Frame& frame, const Pose& camera) const
{
    return std::ranges::any_of(frame.contacts, [&](const frame::Contact& each) {
        const bool first = each.first == scope_;
        if (first == (each.second == scope_) || !frame.softBody(first ? each.second : each.first)) return false;
        return each.normalForce > 0.0 && distance(each.point, camera.position) <= def_->reach;
    });
}

double LensSoiling::smokeBefore(const Pose& camera) const
{
    const Vec3 view = rotate(camera.orientation, {0.0, 0.0, -1.0});
    return simulation_.smokeBetween(camera.position, camera.position + kBefore * view) / kBefore;
}

void LensSoiling::step(double time)
{
    const double dt = std::max(time - std::exchange(state_.last, time), 0.0);
    if (const std::unique_lock lock(mutex_, std::try_to_lock); lock && asked_) // if not, at the next step
        state_.lens = *std::exchange(asked_, std::nullopt);
    else if (!def_)
        return; // nothing has changed
    const frame::FrameRef frame = def_ ? simulation_.physics().latest() : frame::FrameRef();
    if (const frame::RigidBodyFrame* scope = frame ? frame->rigidBody(scope_) : nullptr) {
        const Pose& camera = scope->poses[static_cast<std::size_t>(camera_)];
        if (touches(*frame, camera)) state_.lens.smear += (1.0 - state_.lens.smear) * -std::expm1(-dt / def_->smearing);
        if (time >= state_.lookFrom && simulation_.hasSmoke()) {
            state_.thickness = smokeBefore(camera);
            state_.lookFrom = time + kSmokeLook;
        }
        double& mist = state_.lens.mist;
        mist += (1.0 - mist) * -std::expm1(-state_.thickness * dt / def_->misting);
        mist *= std::exp(-dt / def_->clearing);
    }
    publish();
}

void LensSoiling::draw(visual::View& view, const visual::EndoscopeOptics& made) const
{
    const LensState lens = now();
    const double mist = std::max(made.mist, std::round(kLevels * lens.mist) / kLevels);
    const double smear = std::max(made.smear, std::round(kLevels * lens.smear) / kLevels);
    visual::ViewDef def = view.def();
    if (!def.effects || !def.effects->endoscope) return; // somebody took its optics away
    visual::EndoscopeOptics& optics = *def.effects->endoscope;
    if (optics.mist == mist && optics.smear == smear) return;
    optics.mist = mist;
    optics.smear = smear;
    view.set(def);
}

} // namespace filasofia::prefab
