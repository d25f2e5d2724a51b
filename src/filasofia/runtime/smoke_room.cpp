#include "filasofia/runtime/smoke_room.h"

#include "filasofia/core/validate.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/carried.h"
#include "filasofia/runtime/told_and_kept.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::runtime {
namespace {

using surface::Extract;

std::string shown(Vec3 at) { return text("(", at.x, " ", at.y, " ", at.z, ") m"); }

} // namespace

void SmokeRoom::add(const surface::SmokeDef& def, Vec3 gravity)
{
    const surface::Smoke smoke(def, "smoke");
    const std::lock_guard lock(mutex_);
    if (!state_.all.empty()) fail("smoke: the simulation has a room for it already");
    state_.all.push_back({.smoke = smoke, .start = smoke, .gravity = gravity});
    any_ = true;
}

const SmokeRoom::Room& SmokeRoom::room() const
{
    if (state_.all.empty()) fail("smoke: there is no room for it; addSmoke() makes one");
    return state_.all.front();
}

void SmokeRoom::check(const Extract& command, const physics::PhysicsServer& physics) const
{
    validate(command, "extract");
    checkCarrier(command.body, command.element, physics, "extract");
    const std::lock_guard lock(mutex_);
    const geometry::Box& within = room().smoke.def().room;
    if (!command.body && command.flow > 0.0 && !geometry::contains(within, command.place))
        fail("extract: place must be in the room of the smoke, from ", shown(within.low), " to ", shown(within.high),
             ", got ", shown(command.place));
}

void SmokeRoom::extract(const Extract& command, const physics::PhysicsServer& physics)
{
    check(command, physics);
    const std::lock_guard lock(mutex_);
    auto& openings = state_.all.front().openings;
    if (command.flow > 0.0)
        openings[command.source] = command;
    else
        openings.erase(command.source);
}

surface::SmokeBalance SmokeRoom::balance() const
{
    const std::lock_guard lock(mutex_);
    return room().smoke.balance();
}

double SmokeRoom::depth(Vec3 from, Vec3 to) const
{
    if (!isFinite(from) || !isFinite(to))
        fail("smokeBetween: both points must be finite, got ", shown(from), " and ", shown(to));
    const std::lock_guard lock(mutex_);
    return room().smoke.opticalDepth(from, to);
}

void SmokeRoom::restart()
{
    const std::lock_guard lock(mutex_);
    for (Room& each : state_.all) {
        each.smoke = each.start;
        each.openings.clear();
    }
    fresh_ = true;
}

void SmokeRoom::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, Burnings& burnings)
{
    if (!any_) return;
    const std::lock_guard lock(mutex_);
    Room& room = state_.all.front();
    for (const surface::Fume& each : burnings.takeFumes()) room.smoke.emit(each);
    if (time < room.next - 1e-9) return;
    if (!room.openings.empty()) {
        const frame::FrameRef frame = physics.latest();
        if (!frame || frame->step != step) return; // readers hold all frames: the next step has one
        for (const auto& [source, opening] : room.openings)
            if (const auto place = placeNow(opening, *frame)) room.smoke.extract(*place, opening.flow);
    }
    room.smoke.step(room.gravity, room.last < 0.0 ? 0.0 : time - room.last);
    room.last = time;
    room.next = (std::floor(time * room.smoke.def().rate + 1e-6) + 1.0) / room.smoke.def().rate;
    fresh_ = true;
}

void SmokeRoom::showAgain()
{
    const std::lock_guard lock(mutex_);
    fresh_ = true;
}

std::optional<visual::Smoke> SmokeRoom::takePicture()
{
    if (!any_) return std::nullopt;
    const std::lock_guard lock(mutex_);
    if (!std::exchange(fresh_, false)) return std::nullopt;
    // What is thicker or larger than the picture can show looks like the most that it can.
    constexpr double kUnseen = 1e-4, kMost = 1e6; // [-], [1/m]
    constexpr double kLargest = 1e3;              // [m]
    const surface::Smoke& smoke = state_.all.front().smoke;
    visual::Smoke out{.haze = std::min(smoke.haze(), kMost), .room = smoke.def().room};
    if (out.haze < kUnseen) out.haze = 0.0;
    for (const surface::Puff& puff : smoke.puffs())
        if (const double depth = smoke.middle(puff); depth > kUnseen)
            out.puffs.push_back({.place = puff.place,
                                 .radius = std::min(puff.radius, kLargest),
                                 .depth = std::min(depth, kMost),
                                 .pattern = puff.number % 1000 + puff.age / (puff.age + 5.0)}); // its own, and it turns
    // Smoke is a little bluer than what it is lit by: small particles scatter short waves more.
    const double albedo = smoke.def().albedo;
    out.color = {0.97 * albedo, 0.985 * albedo, albedo};
    const bool something = !out.puffs.empty() || out.haze > 0.0;
    if (!something && !std::exchange(shown_, something)) return std::nullopt;
    shown_ = something;
    return out;
}

void SmokeRoom::fill(RunReport& report) const
{
    const std::lock_guard lock(mutex_);
    if (!state_.all.empty()) report.smoke = state_.all.front().smoke.balance();
}

Memory SmokeRoom::memory()
{
    Memory out = memoryOf("the smoke", mutex_, state_);
    out.restore = [this, restore = out.restore](const std::any& saved) {
        restore(saved);
        const std::lock_guard lock(mutex_);
        any_ = !state_.all.empty();
        fresh_ = true;
    };
    return out;
}

} // namespace filasofia::runtime
