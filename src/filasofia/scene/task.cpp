#include "filasofia/scene/task.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/prefab/body_points.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/scene/has_come.h"
#include "filasofia/scene/remember_past.h"
#include "filasofia/scene/scene_numbers.h"

#include <algorithm>
#include <mutex>
#include <set>

namespace filasofia::scene {
namespace {

using frame::Frame;

/// The groups in which a body touches others. With a soft body's cutting models nothing collides.
std::set<int> groupsOf(const physics::BodyDef& def)
{
    std::set<int> groups;
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&def)) {
        if (rod->collision) groups.insert(rod->collision->group);
    } else if (const auto* soft = std::get_if<physics::SoftBodyDef>(&def)) {
        for (const physics::CollisionDef& each : soft->collision)
            if (!each.cutting) groups.insert(each.group);
    } else {
        for (const physics::CollisionDef& each : std::get<physics::RigidBodyDef>(def).collision)
            groups.insert(each.group);
    }
    return groups;
}

/// What cuts and tears have opened since the run began, or the last reset. Written by the events' thread, read by the
/// stepping one.
class Partings {
public:
    /// `step`: in which it opened. What was before a reset and comes late does not count.
    void add(std::uint64_t step, const physics::Rupture& rupture)
    {
        const std::scoped_lock lock(mutex_);
        Opened& opened = bodies_[rupture.body];
        if (step < opened.since) return;
        if (step > opened.last.step) opened.last = {.step = step};
        for (Opening* each : {&opened.all, &opened.last}) {
            each->area += rupture.area;
            each->pieces += static_cast<int>(rupture.detached.size());
        }
    }
    /// Before each step: a body that has fewer edits than before was reset in the last one, and was whole.
    void look(BodyId body, std::uint64_t edits, std::uint64_t step)
    {
        const std::scoped_lock lock(mutex_);
        Opened& opened = bodies_[body];
        if (edits < opened.edits) {
            opened.since = step;
            opened.all = opened.last.step == step ? opened.last : Opening{};
        }
        opened.edits = edits;
    }
    struct Opening {
        std::uint64_t step = 0;
        double area = 0.0; ///< [m^2]
        int pieces = 0;
    };
    struct Opened {
        Opening all = {}, last = {}; ///< since the reset; in the last step that opened anything
        std::uint64_t edits = 0;     ///< the body's mesh has
        std::uint64_t since = 0;     ///< step of the reset
    };
    using Past = std::map<BodyId, Opened>;
    [[nodiscard]] Past past() const
    {
        const std::scoped_lock lock(mutex_);
        return bodies_;
    }
    void goBack(const Past& past)
    {
        const std::scoped_lock lock(mutex_);
        bodies_ = past;
    }
    [[nodiscard]] bool reached(const Parted& wanted) const
    {
        const std::scoped_lock lock(mutex_);
        const auto found = bodies_.find(wanted.body);
        return found != bodies_.end() && found->second.all.area >= wanted.area &&
               found->second.all.pieces >= wanted.pieces;
    }

private:
    mutable std::mutex mutex_;
    Past bodies_;
};

/// A condition with the ids of the bodies.
class Watch {
public:
    Watch(Condition condition, std::shared_ptr<const Partings> partings)
        : condition_(condition), partings_(std::move(partings))
    {
    }

    [[nodiscard]] bool holds(const Frame& frame)
    {
        return std::visit([&](const auto& each) { return holds(frame, each); }, condition_);
    }
    [[nodiscard]] std::optional<Vec3> target(const Frame& frame) const
    {
        if (const auto* reached = std::get_if<Reached>(&condition_))
            return reached->place ? reached->place : prefab::middleOf(frame, reached->target);
        if (const auto* touched = std::get_if<Touched>(&condition_)) return prefab::middleOf(frame, touched->second);
        if (const auto* held = std::get_if<Held>(&condition_)) return prefab::middleOf(frame, held->body);
        if (const auto* parted = std::get_if<Parted>(&condition_)) return prefab::middleOf(frame, parted->body);
        if (const auto* pierced = std::get_if<Pierced>(&condition_)) return prefab::middleOf(frame, pierced->body);
        return {};
    }

    /// [s], the first state of its step of the task; none: it is yet to come, or nobody asked.
    [[nodiscard]] std::optional<double> past() const { return since_; }
    void goBack(std::optional<double> since) { since_ = since; }

private:
    static bool holds(const Frame& frame, const Reached& reached)
    {
        const auto from = prefab::pointOf(frame, reached.body, reached.element, reached.tip, reached.node);
        const auto to = reached.place ? reached.place : prefab::middleOf(frame, reached.target);
        return from && to && distance(*from, *to) <= reached.within;
    }
    static bool holds(const Frame& frame, const Touched& touched)
    {
        double force = 0.0;
        for (const frame::Contact& each : frame.contacts)
            if ((each.first == touched.first && each.second == touched.second) ||
                (each.first == touched.second && each.second == touched.first))
                force += each.normalForce;
        return force > touched.force;
    }
    static bool holds(const Frame& frame, const Held& held)
    {
        return std::ranges::any_of(frame.attachments, [&](const frame::Attachment& each) {
            if (each.broken || each.points == 0 || !each.to) return false;
            const BodyId other = each.body == held.body ? each.to : each.to == held.body ? each.body : BodyId{};
            return other && (!held.by || other == held.by);
        });
    }
    static bool holds(const Frame& frame, const Pierced& pierced)
    {
        return std::ranges::any_of(frame.channels, [&](const frame::Channel& each) {
            return each.tissue == pierced.body && (!pierced.by || each.inside == pierced.by) &&
                   (each.through || !pierced.through);
        });
    }
    [[nodiscard]] bool holds(const Frame&, const Parted& parted) const { return partings_->reached(parted); }
    bool holds(const Frame& frame, const Waited& waited)
    {
        if (!since_) since_ = frame.time; // the first state of this step of the task
        return hasCome(waited.seconds, frame.time - *since_);
    }

    Condition condition_;
    std::shared_ptr<const Partings> partings_;
    std::optional<double> since_; ///< [s]
};

/// Refuses what could never hold. The condition has the ids of the bodies.
class ConditionCheck {
public:
    ConditionCheck(const physics::PhysicsServer& server, const std::string& path)
        : server_(server), path_(path + ".done")
    {
    }

    void operator()(const Reached& c) const
    {
        if (c.place.has_value() == static_cast<bool>(c.target))
            fail(path_, " must have a place or a target, and not both");
        differ(c.body, c.target);
        prefab::checkBodyPoint(*server_.def(c.body), c.element, c.node, path_ + ".");
    }
    void operator()(const Touched& c) const
    {
        differ(c.first, c.second);
        const std::set<int> one = groupsOf(*server_.def(c.first)), two = groupsOf(*server_.def(c.second));
        if (std::ranges::none_of(one, [&](int group) { return two.contains(group); }))
            fail(path_, " must name two bodies whose collision has a group in common: ",
                 physics::describeBody(*server_.def(c.first)), " and ", physics::describeBody(*server_.def(c.second)),
                 " never touch");
    }
    void operator()(const Held& c) const { differ(c.body, c.by); }
    void operator()(const Parted& c) const
    {
        const physics::BodyDef& def = *server_.def(c.body);
        const auto* soft = std::get_if<physics::SoftBodyDef>(&def);
        const auto* rod = std::get_if<physics::RodBodyDef>(&def);
        if (!(soft && soft->dynamicTopology) && !(rod && rod->dynamicTopology))
            fail(path_, ".body must be a soft body or a rod with dynamicTopology, got ", physics::describeBody(def));
    }
    void operator()(const Pierced& c) const
    {
        const physics::BodyDef& def = *server_.def(c.body);
        const auto* soft = std::get_if<physics::SoftBodyDef>(&def);
        if (!soft || !soft->puncture)
            fail(path_, ".body must be a soft body with a puncture, got ", physics::describeBody(def));
        differ(c.body, c.by);
    }
    void operator()(const Waited&) const {}

private:
    void differ(BodyId a, BodyId b) const
    {
        if (a == b) fail(path_, " must name two bodies, got ", physics::describeBody(*server_.def(a)), " twice");
    }
    const physics::PhysicsServer& server_;
    const std::string path_;
};

prefab::TaskStep stepOf(const SceneTaskStep& step, const std::shared_ptr<Watch>& watch)
{
    return {.name = step.name,
            .instruction = step.instruction,
            .timeLimit = step.timeLimit,
            .done = [watch](const Frame& frame) { return watch->holds(frame); },
            .target = [watch](const Frame& frame) { return watch->target(frame); }};
}

/// The name of a body or instrument of a scene.
std::string nameOf(const SceneDef& scene, BodyId number)
{
    const auto name = [](const auto& def) { return def.name; };
    const std::size_t at = number.value - 1;
    if (at < scene.bodies.size()) return std::visit(name, scene.bodies[at].def);
    return std::visit(name, scene.instruments.at(at - scene.bodies.size()).def);
}

} // namespace

SceneTask withNames(SceneTask task)
{
    std::set<std::string> known;
    for (std::size_t i = 0; i < task.steps.size(); ++i) {
        std::string& name = task.steps[i].name;
        if (name.empty()) name = text("step ", i + 1);
        if (!known.insert(name).second)
            fail("task.steps[", i, "].name must differ from those before it, got '", prefab::shown(name), "'");
    }
    return task;
}

std::shared_ptr<const prefab::Task> addTask(runtime::Simulation& simulation, const SceneTask& task,
                                            const std::vector<BodyId>& ids, prefab::MetricTracker* tracker, bool arrow)
{
    const auto partings = std::make_shared<Partings>();
    simulation.on<runtime::CutEvent>(
        [partings](const runtime::CutEvent& cut) { partings->add(cut.step, cut.rupture); });
    simulation.on<runtime::TearEvent>(
        [partings](const runtime::TearEvent& tear) { partings->add(tear.step, tear.rupture); });
    rememberPast(simulation, "what a task saw cut and torn", partings);
    std::vector<BodyId> parted;
    prefab::TaskDef def{.name = task.name, .timeLimit = task.timeLimit, .tracker = tracker};
    for (std::size_t i = 0; i < task.steps.size(); ++i) {
        Condition condition = task.steps[i].done;
        SceneNumbers(ids).replaceIn(condition);
        std::visit(ConditionCheck(simulation.physics(), text("task.steps[", i, "]")), condition);
        if (const auto* of = std::get_if<Parted>(&condition)) parted.push_back(of->body);
        const auto watch = std::make_shared<Watch>(condition, partings);
        def.steps.push_back(stepOf(task.steps[i], watch));
        rememberPast(simulation, text("step ", i + 1, " of a task"), watch);
    }
    if (!parted.empty())
        simulation.everyStep([&simulation, partings, parted](double) {
            const frame::FrameRef now = simulation.physics().latest();
            for (const BodyId body : parted)
                if (const auto* soft = now ? now->softBody(body) : nullptr)
                    partings->look(body, soft->boundary ? soft->boundary->revision : 0, now->step);
        });
    def.over = [&simulation, name = task.name](bool done) {
        simulation.finish(text("task '", prefab::shown(name), done ? "' is done" : "' is out of time"));
    };
    const auto made = std::make_shared<const prefab::Task>(simulation, std::move(def));
    const auto guidance = std::make_shared<prefab::Guidance>(simulation, *made);
    if (arrow) simulation.dress([guidance](visual::VisualServer& visual) { guidance->dress(visual); });
    simulation.everyStep([made, guidance](double) {}); // they last as long as the simulation
    return made;
}

std::shared_ptr<prefab::MetricTracker> addTracker(runtime::Simulation& simulation, const SceneDef& scene,
                                                  const std::vector<BodyId>& ids, prefab::MetricTrackerDef def)
{
    const bool wanted = !def.file.empty() || def.keep || def.write;
    if (scene.measured.empty()) {
        if (wanted) fail("measured must name a body: without one there is nothing to write");
        return {};
    }
    def.bodies = scene.measured;
    for (prefab::TrackedBody& each : def.bodies) SceneNumbers(ids).replaceIn(each);
    def.session.watched = {metric::EventKind::Cut, metric::EventKind::Tear};
    if (scene.task) {
        def.session.task = scene.task->name;
        def.session.watched.insert(def.session.watched.end(), {metric::EventKind::Step, metric::EventKind::Mistake,
                                                               metric::EventKind::Unfinished});
        for (const SceneTaskStep& step : withNames(*scene.task).steps) {
            def.session.steps.push_back(step.name);
            if (const auto* parted = std::get_if<Parted>(&step.done))
                def.session.targets.push_back(nameOf(scene, parted->body));
        }
    }
    if (wanted) return std::make_shared<prefab::MetricTracker>(simulation, std::move(def));
    prefab::MetricTracker::check(simulation, def); // what is wrong is found before somebody wants to measure
    return {};
}

} // namespace filasofia::scene
