#include "filasofia/runtime/distended_cavity.h"

#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/told_and_kept.h"
#include "filasofia/visual/visual_server.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::runtime {
namespace {

constexpr visual::Color kClear{0.80, 0.78, 0.74}; ///< share of light that the fluid's own clouds scatter
constexpr visual::Color kBlood{0.62, 0.05, 0.03}; ///< and blood

/// What a picture shows of the fluid. What is thicker than the picture can show looks like the most that it can.
visual::Smoke seenOf(const surface::Distension& fluid)
{
    constexpr double kMost = 1e6; // [1/m]
    const surface::DistensionDef& def = fluid.def();
    const double blood = def.extinction * surface::bloodShare(fluid.balance()), all = blood + def.turbidity;
    const auto mixed = [share = all > 0.0 ? blood / all : 0.0](double clear, double red) {
        return (1.0 - share) * clear + share * red;
    };
    return {
        .haze = all > 1e-3 ? std::min(all, kMost) : 0.0,
        .room = def.room,
        .color = {mixed(kClear.red, kBlood.red), mixed(kClear.green, kBlood.green), mixed(kClear.blue, kBlood.blue)}};
}

const geometry::TriangleMesh& ball()
{
    static const auto made = geometry::shapes::sphere(1.0, 2);
    return *made;
}

/// All bubbles in one mesh; those that there are not hide in the first.
std::vector<Vec3> cornersOf(const std::vector<surface::Bubble>& bubbles)
{
    constexpr double kHidden = 0.2; // times the first's radius
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < surface::Distension::kMostBubbles; ++i) {
        const bool there = i < bubbles.size();
        const surface::Bubble& bubble = bubbles[there ? i : 0];
        const double radius = surface::radiusOf(bubble) * (there ? 1.0 : kHidden);
        for (const Vec3& corner : ball().vertices) out.push_back(bubble.place + radius * corner);
    }
    return out;
}

geometry::TriangleMesh meshOf(const std::vector<surface::Bubble>& bubbles)
{
    geometry::TriangleMesh out;
    out.vertices = cornersOf(bubbles);
    const auto count = static_cast<int>(ball().vertices.size());
    for (std::size_t i = 0; i < surface::Distension::kMostBubbles; ++i)
        for (geometry::Triangle each : ball().triangles) {
            for (int& corner : each) corner += static_cast<int>(i) * count;
            out.triangles.push_back(each);
        }
    return out;
}

} // namespace

void DistendedCavity::add(const surface::DistensionDef& def, Vec3 gravity)
{
    const surface::Distension fluid(def, "distension");
    const std::lock_guard lock(mutex_);
    if (!state_.all.empty()) fail("distension: the simulation has one already");
    state_.all.push_back({.fluid = fluid, .start = fluid, .gravity = gravity});
    any_ = true;
}

const DistendedCavity::Cavity& DistendedCavity::cavity() const
{
    if (state_.all.empty()) fail("distension: there is none; addDistension() makes one");
    return state_.all.front();
}

void DistendedCavity::check(const surface::Distend& command) const
{
    validate(command, "distend");
    const std::lock_guard lock(mutex_);
    static_cast<void>(cavity());
}

void DistendedCavity::apply(const surface::Distend& command)
{
    check(command);
    const std::lock_guard lock(mutex_);
    state_.all.front().fluid.apply(command);
}

surface::DistensionBalance DistendedCavity::balance() const
{
    const std::lock_guard lock(mutex_);
    return cavity().fluid.balance();
}

void DistendedCavity::restart()
{
    const std::lock_guard lock(mutex_);
    for (Cavity& each : state_.all) {
        each.fluid = each.start;
        each.given.clear();
        each.healing = true;
        each.told = {};
        each.tellFrom = 0.0;
    }
    fresh_ = true;
}

void DistendedCavity::heat(Cavity& cavity, const std::vector<Electrodes::Given>& given)
{
    for (const Electrodes::Given& each : given) {
        double& before = cavity.given[each.electrode];
        cavity.fluid.heat(each.place, each.energy - std::exchange(before, each.energy));
    }
}

/// Layers of blood heal some steps after a reset. What they tell until then was before it.
double DistendedCavity::welled(Cavity& cavity, double all)
{
    if (cavity.healing && all > 0.0 && all >= cavity.bled) {
        cavity.bled = all;
        return 0.0;
    }
    const double before = std::exchange(cavity.bled, all);
    return std::exchange(cavity.healing, false) ? all : std::max(all - before, 0.0);
}

bool DistendedCavity::mustTell(const Cavity& cavity)
{
    const surface::DistensionBalance now = cavity.fluid.balance();
    if (now == cavity.told) return false;
    return cavity.last >= cavity.tellFrom || now.beyondLimit != cavity.told.beyondLimit;
}

void DistendedCavity::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics,
                                const Sources& sources)
{
    if (!any_) return;
    const std::lock_guard lock(mutex_);
    Cavity& cavity = state_.all.front();
    if (time < cavity.next - 1e-9) return;
    if (sources.electrodes.any()) {
        const frame::FrameRef frame = physics.latest();
        if (!frame || frame->step != step) return; // readers hold all frames: the next step has one
        heat(cavity, sources.electrodes.given(*frame));
    }
    cavity.fluid.bleed(welled(cavity, sources.bleedings.told()));
    cavity.fluid.step(cavity.gravity, cavity.last < 0.0 ? 0.0 : time - cavity.last);
    cavity.last = time;
    const double rate = cavity.fluid.def().rate;
    cavity.next = (std::floor(time * rate + 1e-6) + 1.0) / rate;
    fresh_ = true;
    if (!mustTell(cavity)) return;
    cavity.told = cavity.fluid.balance();
    cavity.tellFrom = nextTelling(time);
    told_ = cavity.told;
}

std::optional<surface::DistensionBalance> DistendedCavity::takeTold()
{
    return any_ ? std::exchange(told_, std::nullopt) : std::nullopt;
}

void DistendedCavity::showAgain()
{
    const std::lock_guard lock(mutex_);
    bubbles_ = nullptr;
    fresh_ = true;
}

void DistendedCavity::draw(visual::VisualServer& visual)
{
    if (!any_) return;
    const std::lock_guard lock(mutex_);
    if (!std::exchange(fresh_, false)) return;
    const surface::Distension& fluid = state_.all.front().fluid;
    visual.setSmoke(seenOf(fluid));
    drawBubbles(visual, fluid.bubbles());
}

void DistendedCavity::drawBubbles(visual::VisualServer& visual, const std::vector<surface::Bubble>& bubbles)
{
    if (bubbles.empty()) {
        if (bubbles_ != nullptr) bubbles_->setVisible(false);
        return;
    }
    if (bubbles_ == nullptr)
        bubbles_ = &visual.add(visual::VisualBodyDef{
            .name = "bubbles",
            .mesh = meshOf(bubbles),
            .material = visual::GlassMaterial{.tint = {1.0, 1.0, 1.0}, .roughness = 0.0, .refractiveIndex = 1.33},
            .castShadows = false});
    bubbles_->setVisible(true);
    bubbles_->setVertices(cornersOf(bubbles));
}

void DistendedCavity::fill(RunReport& report) const
{
    const std::lock_guard lock(mutex_);
    if (!state_.all.empty()) report.distension = state_.all.front().fluid.balance();
}

Memory DistendedCavity::memory()
{
    Memory out = memoryOf("the distension", mutex_, state_);
    out.restore = [this, restore = out.restore](const std::any& saved) {
        restore(saved);
        const std::lock_guard lock(mutex_);
        any_ = !state_.all.empty();
        told_.reset();
        fresh_ = true;
    };
    return out;
}

} // namespace filasofia::runtime
