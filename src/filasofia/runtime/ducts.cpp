#include "filasofia/runtime/ducts.h"

#include "filasofia/core/validate.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/runtime/told_and_kept.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
namespace {

constexpr double kPouring = 0.05; // [s] between two tellings of what flows onto a body: each is a line of a recording

} // namespace

int Ducts::add(BodyId id, const surface::DuctDef& def, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("duct '", def.name, "' of ", physics::describeBody(*body));
    const auto* soft = std::get_if<physics::SoftBodyDef>(body.get());
    if (soft == nullptr || physics::isShell(*soft)) fail(object, ": needs a soft body of tetrahedra");
    validate(def, object);
    surface::Duct duct(def, physics::worldMesh(*soft), skinOf(*soft, object), object);
    const std::lock_guard lock(mutex_);
    const auto index = static_cast<int>(std::ranges::count(state_.all, id, &Known::body));
    state_.all.push_back({.body = id, .index = index, .name = soft->name, .duct = std::move(duct)});
    any_ = true;
    return index;
}

const Ducts::Known& Ducts::find(BodyId id, int duct) const
{
    for (const Known& each : state_.all)
        if (each.body == id && each.index == duct) return each;
    const auto has = std::ranges::count(state_.all, id, &Known::body);
    if (has == 0) fail("duct: body ", id.value, " has none; addDuct() makes one");
    fail("duct of body ", id.value, ": duct must be in [0, ", has, "), got ", duct);
}

surface::DuctBalance Ducts::balance(BodyId id, int duct) const
{
    const std::lock_guard lock(mutex_);
    return find(id, duct).duct.balance();
}

void Ducts::restart()
{
    const std::lock_guard lock(mutex_);
    for (Known& each : state_.all) {
        if (const std::uint64_t last = each.duct.revision(); last > 0) each.old = last;
        each.duct.restart();
        each.poured = {};
        each.pourFrom = 0.0;
        each.revision = 0;
        each.told.reset();
        each.tellFrom = 0.0;
    }
}

bool Ducts::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Told& told)
{
    if (!any_) return true;
    const frame::FrameRef frame = physics.latest();
    if (!frame || frame->step != step) return true; // readers hold all frames: the next step has its time, too
    const std::lock_guard lock(mutex_);
    const double dt = std::max(time - std::exchange(state_.last, time), 0.0);
    bool all = true;
    std::erase_if(state_.all, [&](const Known& each) { return !physics.has(each.body); });
    for (Known& each : state_.all) {
        const frame::SoftBodyFrame* body = frame->softBody(each.body);
        if (body == nullptr) continue; // it is not there yet
        const std::uint64_t revision = body->boundary ? body->boundary->revision : 0;
        if (each.old > 0 && revision >= each.old) continue; // the reset has not come yet
        each.old = 0;
        clips_.clear();
        for (const frame::Clip& clip : frame->clips)
            if (clip.tissue == each.body) clips_.push_back(clip);
        each.duct.step({.positions = body->positions, .boundary = body->boundary.get(), .clips = clips_}, dt);
        tellEnds(time, dt, each, told);
        all = tell(time, each, told) && all;
    }
    return all;
}

// What flows out of an end is the duct's: the body's own law must not tell it again.
void Ducts::tellEnds(double time, double dt, Known& known, const Told& told)
{
    const auto& ends = known.duct.ends();
    const double reach = 3.0 * known.duct.def().radius;
    const bool opened = std::exchange(known.revision, known.duct.revision()) != known.duct.revision();
    for (std::size_t i = 0; i < ends.size(); ++i) {
        known.poured[i] += dt * ends[i].leak;
        if (opened) told.seal(known.body, ends[i].place, reach);
        if (known.poured[i] == 0.0 || time < known.pourFrom) continue;
        told.pour(known.body, ends[i].place, reach, std::exchange(known.poured[i], 0.0));
    }
    if (time >= known.pourFrom) known.pourFrom = time + kPouring;
}

bool Ducts::tell(double time, Known& known, const Told& told)
{
    const surface::DuctBalance& now = known.duct.balance();
    const auto& last = known.told;
    const bool changed =
        !last || last->state != now.state || last->clipsBefore != now.clipsBefore || last->clipsAfter != now.clipsAfter;
    if (!changed && (now.leak == 0.0 || time < known.tellFrom)) return true;
    known.told = now;
    known.tellFrom = nextTelling(time);
    return told.post(known.body, known.index, now);
}

void Ducts::fill(RunReport& report) const
{
    const std::lock_guard lock(mutex_);
    report.ducts.clear();
    for (const Known& each : state_.all) report.ducts.push_back({each.name, each.duct.def().name, each.duct.balance()});
}

Memory Ducts::memory() { return memoryOf("the ducts", mutex_, state_); }

} // namespace filasofia::runtime
