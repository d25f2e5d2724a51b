#include "filasofia/runtime/ducts.h"

#include "filasofia/core/validate.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/runtime/told_and_kept.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
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
        each.leaks.clear();
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
    std::vector<frame::Clip> clips;
    for (Known& each : state_.all) {
        const frame::SoftBodyFrame* body = frame->softBody(each.body);
        if (body == nullptr) continue; // it was removed
        const std::uint64_t revision = body->boundary ? body->boundary->revision : 0;
        if (each.old > 0 && revision >= each.old) continue; // the reset has not come yet
        each.old = 0;
        clips.clear();
        for (const frame::Clip& clip : frame->clips)
            if (clip.tissue == each.body) clips.push_back(clip);
        each.duct.step({.positions = body->positions, .boundary = body->boundary.get(), .clips = clips}, dt);
        tellEnds(each, told);
        all = tell(time, each, told) && all;
    }
    return all;
}

void Ducts::tellEnds(Known& known, const Told& told)
{
    const auto& ends = known.duct.ends();
    const bool fresh = known.leaks.size() != ends.size(); // the body's own law lets a fresh cut bleed
    known.leaks.resize(ends.size(), 1);
    const bool opened = std::exchange(known.revision, known.duct.revision()) != known.duct.revision();
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const bool leaks = ends[i].leaks;
        const bool same = std::exchange(known.leaks[i], leaks ? 1 : 0) == (leaks ? 1 : 0);
        if (same && (leaks || !opened)) continue; // what a blade opens later at a shut end is shut, too
        if (!(fresh && leaks)) told.end(known.body, ends[i].place, 3.0 * known.duct.def().radius, leaks);
    }
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
