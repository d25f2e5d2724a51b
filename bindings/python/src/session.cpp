#include "session.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"

#include <pthread.h>

#include <chrono>
#include <mutex>
#include <set>
#include <thread>

namespace filasofia::python {
namespace {

/// How often this process has been made by fork(), since the module was loaded in an ancestor.
std::atomic<int> forkCount = 0;

int forksUntilNow()
{
    static const int registered = pthread_atfork(nullptr, nullptr, [] { forkCount.fetch_add(1); });
    static_cast<void>(registered);
    return forkCount.load(std::memory_order_relaxed);
}

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

} // namespace

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
    // As runtime rounds it: whole nanoseconds.
    period_ = runtime::toSeconds(runtime::toNanoseconds(1.0 / def.physics.rate));
    simulation_.everyStep([this](double time) {
        if (beforeStep) beforeStep(time);
    });
}

void Session::requireUsable(const char* what) const
{
    if (forksUntilNow() != forks_)
        fail(what, ": the process has forked since this simulation was made, and its threads are in the parent; make "
                   "simulations after the fork");
    if (closed_.load()) fail(what, ": the simulation is closed");
}

bool Session::usable() const { return forksUntilNow() == forks_ && !closed_.load(); }

Session::Turn::Turn(Session& session, const char* what) : session_(session)
{
    session.requireUsable(what);
    if (session.busy_.test_and_set(std::memory_order_acquire))
        fail(what, ": another thread is stepping or drawing this simulation, or a callback of its step asks for it");
    if (session.closed_.load()) { // meanwhile
        session.busy_.clear(std::memory_order_release);
        fail(what, ": the simulation is closed");
    }
}

void Session::record(const runtime::RunDef& def)
{
    if (run_) fail("record: must be called before the first step and the first picture");
    asked_ = def;
    begin();
}

void Session::begin()
{
    if (!run_) run_.emplace(simulation_, asked_);
}

physics::StepReport Session::step()
{
    begin();
    physics::StepReport report = run_->step();
    time_.store(report.time, std::memory_order_relaxed);
    steps_.store(report.step, std::memory_order_relaxed);
    return report;
}

visual::Image Session::picture(const runtime::PictureDef& def)
{
    begin();
    return run_->picture(def);
}

runtime::RunReport Session::report()
{
    if (closed_.load()) return final_;
    begin();
    return run_->report();
}

void Session::close()
{
    if (closed_.exchange(true)) return;
    if (run_) final_ = run_->end();
}

template <class E> void Session::collectAll()
{
    simulation_.on<E>([this](const E& event) { arrived_.emplace_back(event); });
}

void Session::collect(std::size_t alternative)
{
    if (collected_.at(alternative).exchange(true)) return;
    switch (alternative) {
    case 0:
        return collectAll<runtime::ContactEvent>();
    case 1:
        return collectAll<runtime::CutEvent>();
    case 2:
        return collectAll<runtime::TearEvent>();
    case 3:
        return collectAll<runtime::FileFailedEvent>();
    default:
        return collectAll<event::PhysicsUpdateEvent>();
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
    for (const auto& session : all)
        while (session->usable()) {
            try {
                const Session::Turn turn(*session, "close");
                session->close();
            } catch (const Error&) { // a thread that steps ends its step, and its next one fails
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        }
}

} // namespace filasofia::python
