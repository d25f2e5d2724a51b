#include "filasofia/runtime/stop_signal.h"

#include <atomic>

namespace filasofia::runtime {
namespace {

std::atomic<bool> stopReceived = false; // the only thing that a signal handler may safely touch
static_assert(std::atomic<bool>::is_always_lock_free);

void onStop(int) { stopReceived.store(true, std::memory_order_relaxed); }

} // namespace

StopSignal::StopSignal()
{
    stopReceived.store(false);
    struct sigaction action {};
    action.sa_handler = onStop;
    action.sa_flags = SA_RESETHAND; // the next signal has its default effect again
    sigaction(SIGINT, &action, &interrupt_);
    sigaction(SIGTERM, &action, &terminate_);
    sigaction(SIGHUP, nullptr, &hangUp_);
    if (hangUp_.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr); // nohup wants the run to go on
}

StopSignal::~StopSignal()
{
    sigaction(SIGINT, &interrupt_, nullptr);
    sigaction(SIGTERM, &terminate_, nullptr);
    sigaction(SIGHUP, &hangUp_, nullptr);
}

bool StopSignal::received() { return stopReceived.load(std::memory_order_relaxed); }

} // namespace filasofia::runtime
