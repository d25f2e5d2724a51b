#include "session.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

namespace filasofia::python {
namespace {

/// How often this process has been made by fork(), since the module was loaded in an ancestor.
std::atomic<int> forkCount = 0;

int forksUntilNow() { return forkCount.load(std::memory_order_relaxed); }

constexpr auto kPatience = std::chrono::seconds(5); ///< how long the end of the interpreter waits for steps

/// The sessions that exist, so that they can be closed while their threads still run.
struct Registry {
    std::mutex mutex;
    std::set<std::weak_ptr<Session>, std::owner_less<>> sessions;
};
Registry& registry()
{
    static auto* const made = new Registry; // never destroyed: sessions may outlive the static objects
    return *made;
}

/// Closes a session, unless somebody steps or draws it.
bool tryClose(Session& session)
{
    try {
        const Session::Turn turn(session, "close");
        session.close();
    } catch (const Error&) {
        return !session.usable();
    }
    return true;
}

} // namespace

void watchForks()
{
    static_cast<void>(registry());
    // The thread that forks takes the lock before: another one may hold it, which is not there in the child.
    const int problem = pthread_atfork([] { registry().mutex.lock(); }, [] { registry().mutex.unlock(); },
                                       [] {
                                           forkCount.fetch_add(1);
                                           registry().mutex.unlock();
                                       });
    if (problem != 0) logWarning("python: fork() cannot be watched: do not use simulations in a forked process");
}

std::shared_ptr<Session> Session::make(const runtime::SimulationDef& def)
{
    const int forks = forksUntilNow();
    std::shared_ptr<Session> made(new Session(def), [forks](Session* session) {
        if (forksUntilNow() == forks) delete session;
    });
    made->forks_ = forks;
    const std::lock_guard lock(registry().mutex);
    std::erase_if(registry().sessions, [](const auto& each) { return each.expired(); });
    registry().sessions.insert(made);
    return made;
}

Session::Session(const runtime::SimulationDef& def) : simulation_(def)
{
    period_ = 1.0 / def.physics.rate;
    simulation_.everyStep([this](double time) {
        if (beforeStep) beforeStep(time);
    });
}

void Session::requireUsable(const char* what) const
{
    if (foreign())
        fail(what, ": the process has forked since this simulation was made, and its threads are in the parent; make "
                   "simulations after the fork");
    if (closed()) fail(what, ": the simulation is closed");
}

bool Session::foreign() const { return forksUntilNow() != forks_; }

Session::Turn::Turn(Session& session, const char* what, Of of) : session_(session)
{
    if (of == Of::Open || session.foreign()) session.requireUsable(what);
    if (session.busy_.test_and_set(std::memory_order_acquire))
        fail(what, ": another thread is stepping or drawing this simulation, or a callback of its step asks for it");
    if (of == Of::Open && session.closed()) { // meanwhile
        session.busy_.clear(std::memory_order_release);
        fail(what, ": the simulation is closed");
    }
}

void Session::record(const runtime::RunDef& def)
{
    if (run_) fail("record: must be called before the first step and the first picture");
    run_.emplace(simulation_, def); // if it throws, there is no run, and the next one may be recorded
}

runtime::SteppedRun& Session::running() { return run_ ? *run_ : run_.emplace(simulation_); }

physics::StepReport Session::step()
{
    physics::StepReport report = running().step();
    time_.store(report.time, std::memory_order_relaxed);
    steps_.store(report.step, std::memory_order_release); // after its frame was published
    return report;
}

std::shared_ptr<const runtime::RunState> Session::save()
{
    if (!run_) fail("save_state: make a step first");
    return running().save();
}

void Session::restore(const runtime::RunState& state)
{
    if (!run_) fail("restore: make a step first");
    running().restore(state);
    const frame::FrameRef now = physics().latest();
    time_.store(now->time, std::memory_order_relaxed);
    steps_.store(now->step, std::memory_order_release);
}

visual::Image Session::picture(const runtime::PictureDef& def) { return running().picture(def); }

visual::DepthImage Session::depth(const runtime::PictureDef& def) { return running().depth(def); }

void Session::openViewer(const runtime::ViewerDef& def)
{
    running().openViewer(def);
    viewed_.store(true);
}

runtime::RunReport Session::report()
{
    if (closed()) return final_;
    if (run_) return run_->report();
    runtime::RunReport none;
    none.hash = physics().hash();
    none.finished = "not yet";
    return none;
}

std::uint64_t Session::hash() { return closed() ? final_.hash : physics().hash(); }

void Session::add(const scene::SceneDef& scene, const prefab::MetricTrackerDef& tracker, const std::string& sensorsFile)
{
    scene_ = scene::addScene(simulation_, scene, tracker, sensorsFile);
    if (scene_.tracker) trackers_.push_back(scene_.tracker);
}

void Session::measure(prefab::MetricTrackerDef def)
{
    if (run_) fail("measure: the run has begun: measure before the first step");
    auto made = std::make_shared<prefab::MetricTracker>(simulation_, std::move(def));
    const std::scoped_lock lock(trackersMutex_);
    trackers_.push_back(std::move(made));
}

void Session::mark(metric::EventKind kind, const std::string& what, std::optional<double> amount)
{
    const std::scoped_lock lock(trackersMutex_);
    if (trackers_.empty()) fail("mark: nothing is measured: call measure() before the first step");
    for (const auto& each : trackers_) each->mark(kind, what, amount);
}

void Session::close()
{
    if (closed()) return;
    // Others may read the final report without a turn as soon as they see that it is closed: so that comes last, also
    // if the end of the run fails.
    struct Closing {
        std::atomic<bool>& closed;
        ~Closing() { closed.store(true); }
    };
    const Closing last{closed_};
    {
        const std::scoped_lock lock(trackersMutex_);
        if (scene_.task) scene_.task->leave();
        for (const auto& each : trackers_) each->close();
        if (scene_.sensors) scene_.sensors->close();
    }
    final_ = report();
    if (run_)
        final_ = run_->end();
    else
        final_.finished = "made 0 steps";
}

template <class E> void Session::observe(std::size_t alternative)
{
    simulation_.on<E>([this, &wanted = collected_.at(alternative).wanted](const E& event) {
        if (wanted.load(std::memory_order_relaxed)) arrived_.emplace_back(event);
    });
}

void Session::collect(std::size_t alternative, bool on)
{
    Collected& collected = collected_.at(alternative);
    collected.wanted.store(on, std::memory_order_relaxed);
    if (!on || collected.observed.exchange(true)) return;
    switch (alternative) {
    case 0:
        return observe<runtime::ContactEvent>(alternative);
    case 1:
        return observe<runtime::CutEvent>(alternative);
    case 2:
        return observe<runtime::TearEvent>(alternative);
    case 3:
        return observe<runtime::IntersectionEvent>(alternative);
    case 4:
        return observe<runtime::BleedingEvent>(alternative);
    case 5:
        return observe<runtime::BurnEvent>(alternative);
    case 6:
        return observe<runtime::EnergyEvent>(alternative);
    case 7:
        return observe<runtime::DuctEvent>(alternative);
    case 8:
        return observe<runtime::ClipEvent>(alternative);
    case 9:
        return observe<runtime::BreakEvent>(alternative);
    case 10:
        return observe<runtime::DistensionEvent>(alternative);
    case 11:
        return observe<runtime::FileFailedEvent>(alternative);
    default:
        return observe<event::PhysicsUpdateEvent>(alternative);
    }
}

void closeAll()
{
    std::vector<std::shared_ptr<Session>> all;
    {
        const std::lock_guard lock(registry().mutex);
        for (const auto& each : registry().sessions)
            if (auto session = each.lock()) all.push_back(std::move(session));
    }
    for (const auto& session : all) session->askEnd();
    const auto until = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
        std::erase_if(all, [](const auto& session) { return tryClose(*session); });
        if (all.empty()) return;
        if (std::chrono::steady_clock::now() > until) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1)); // a thread that steps ends its step, and fails
    }
    logWarning("python: the interpreter ends while ", all.size(),
               all.size() == 1 ? " simulation is" : " simulations are",
               " in a step or a callback; what they write may be incomplete");
}

} // namespace filasofia::python
