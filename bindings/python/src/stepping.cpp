#include "stepping.h"

#include "results.h"

#include "filasofia/core/error.h"

#include <chrono>
#include <exception>
#include <optional>
#include <utility>

namespace filasofia::python {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr auto kSignals = std::chrono::milliseconds(50); ///< how often a long call looks for Ctrl-C

/// Calls the callbacks of one step. The first exception is kept; the lock must be held.
class Callbacks {
public:
    explicit Callbacks(HeldSimulation& held) : held_(held) {}

    template <class... Arguments> void call(std::size_t alternative, const Arguments&... arguments)
    {
        // A copy, because a callback may attach and detach; what it detaches is not called any more.
        std::vector<std::pair<std::uint64_t, nb::object>> calls;
        for (const Observer& each : held_.observers)
            if (each.alternative == alternative) calls.emplace_back(each.id, each.call);
        for (const auto& [id, function] : calls) {
            if (!isAttached(id)) continue;
            try {
                function(arguments...);
            } catch (nb::python_error& problem) {
                keep(problem, function);
            }
        }
    }
    void keepSignal()
    {
        if (PyErr_CheckSignals() == 0) return;
        nb::python_error problem;
        keep(problem, nb::none());
    }
    [[nodiscard]] bool failed() const { return problem_ != nullptr; }
    void rethrow()
    {
        if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
    }

private:
    [[nodiscard]] bool isAttached(std::uint64_t id) const
    {
        for (const Observer& each : held_.observers)
            if (each.id == id) return true;
        return false;
    }
    void keep(nb::python_error& problem, nb::handle function)
    {
        if (problem_)
            problem.discard_as_unraisable(function);
        else
            problem_ = std::make_exception_ptr(std::move(problem));
    }

    HeldSimulation& held_;
    std::exception_ptr problem_;
};

void deliver(Session& session, Callbacks& callbacks)
{
    for (Arrived& event : session.takeArrived()) {
        const std::size_t alternative = event.index();
        callbacks.call(alternative, eventObject(std::move(event)));
    }
}

/// While it lives, the scripts of every step are called.
class Scripts {
public:
    Scripts(HeldSimulation& held, Callbacks& callbacks) : session_(*held.session)
    {
        session_.beforeStep = [&held, &callbacks](double time) {
            if (!held.scripted.load(std::memory_order_relaxed)) return; // a step takes no lock that it does not need
            const nb::gil_scoped_acquire lock;
            callbacks.call(Observer::kEveryStep, nb::float_(time));
        };
    }
    ~Scripts() { session_.beforeStep = {}; }
    Scripts(const Scripts&) = delete;
    Scripts& operator=(const Scripts&) = delete;

private:
    Session& session_;
};

Pose poseAfter(const Move& move, std::uint64_t steps, std::uint64_t count)
{
    if (steps == count) return move.to; // with no rounding
    return between(move.from, move.to, static_cast<double>(steps) / static_cast<double>(count));
}

} // namespace

HeldSimulation::~HeldSimulation()
{
    if (!session) return;
    try {
        const Session::Turn turn(*session, "close");
        session->close();
    } catch (const std::exception&) {
        // Closed already, or of a parent process; nobody else can be stepping it, since nobody holds it.
    }
}

physics::StepReport makeSteps(HeldSimulation& held, std::uint64_t count, const char* what,
                              const std::vector<Move>& moves)
{
    Session& session = *held.session;
    Callbacks callbacks(held);
    std::optional<Scripts> scripts;
    if (count > 1 || held.scripted.load()) scripts.emplace(held, callbacks);
    physics::StepReport report;
    {
        const nb::gil_scoped_release free;
        Time looked = count > 1 ? std::chrono::steady_clock::now() : Time{};
        for (std::uint64_t i = 0; i < count && !callbacks.failed() && !session.endAsked(); ++i) {
            for (const Move& each : moves)
                session.physics().setPose(each.body, poseAfter(each, i + 1, count), each.element);
            report = session.step();
            const bool look = count > 1 && std::chrono::steady_clock::now() - looked > kSignals;
            if (!look && !session.anyArrived()) continue;
            const nb::gil_scoped_acquire lock;
            deliver(session, callbacks);
            if (!look) continue;
            callbacks.keepSignal();
            looked = std::chrono::steady_clock::now();
        }
    }
    scripts.reset();
    callbacks.rethrow();
    if (session.endAsked()) fail(what, ": the interpreter ends");
    return report;
}

} // namespace filasofia::python
