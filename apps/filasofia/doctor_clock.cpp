#include "apps/filasofia/doctor_report.h"
#include "filasofia/core/text.h"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::app {
namespace {

constexpr const char* kRealTimeHint = "put '@audio - rtprio 80' (with your group instead of audio) into "
                                      "/etc/security/limits.d/filasofia.conf and log in again";

/// Whether this thread may run under SCHED_FIFO. The previous policy is restored at once.
bool realTimeAllowed()
{
    int policy = 0;
    sched_param before = {};
    if (pthread_getschedparam(pthread_self(), &policy, &before) != 0) return false;
    sched_param wanted = {};
    wanted.sched_priority = sched_get_priority_min(SCHED_FIFO);
    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) != 0) return false;
    pthread_setschedparam(pthread_self(), policy, &before);
    return true;
}

std::string realTimeLimit()
{
    rlimit limit = {};
    if (getrlimit(RLIMIT_RTPRIO, &limit) != 0) return "unknown";
    return limit.rlim_cur == RLIM_INFINITY ? "unlimited" : text(limit.rlim_cur);
}

std::string preemption()
{
    utsname name = {};
    if (uname(&name) != 0) return "unknown";
    const std::string_view version = name.version;
    for (const char* model : {"PREEMPT_RT", "PREEMPT_DYNAMIC", "PREEMPT"})
        if (version.find(model) != std::string_view::npos) return model;
    return "none";
}

timespec later(timespec time, long nanoseconds)
{
    constexpr long kSecond = 1'000'000'000;
    time.tv_nsec += nanoseconds;
    if (time.tv_nsec >= kSecond) {
        time.tv_nsec -= kSecond;
        ++time.tv_sec;
    }
    return time;
}

double microsecondsBetween(timespec from, timespec to)
{
    return static_cast<double>(to.tv_sec - from.tv_sec) * 1e6 + static_cast<double>(to.tv_nsec - from.tv_nsec) * 1e-3;
}

/// Lateness [us] of a thread at each of 200 ticks of a 1 ms grid, sorted.
std::array<double, 200> wakeLateness()
{
    std::array<double, 200> lateness = {};
    timespec due = {};
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (double& late : lateness) {
        due = later(due, 1'000'000);
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) != 0) { // woken early by a signal
        }
        timespec now = {};
        clock_gettime(CLOCK_MONOTONIC, &now);
        late = std::round(microsecondsBetween(due, now));
    }
    std::sort(lateness.begin(), lateness.end());
    return lateness;
}

} // namespace

Section examineScheduling()
{
    const bool allowed = realTimeAllowed();
    Finding preempt = {.name = "kernel preemption", .value = preemption()};
    if (std::get<std::string>(preempt.value) == "none")
        preempt.hint = "a kernel with preemption (Debian: linux-image-rt-amd64) wakes threads with less delay";
    return {.title = "scheduling",
            .findings = {{.name = "real-time priority", .value = allowed, .hint = allowed ? "" : kRealTimeHint},
                         {.name = "real-time limit", .value = realTimeLimit()},
                         preempt}};
}

Section examineTimer()
{
    const auto lateness = wakeLateness();
    const double p99 = lateness[lateness.size() * 99 / 100];
    // A haptic servo runs at 1 kHz; it can lose a tenth of its period unnoticed.
    const char* hint = p99 > 100.0
                           ? "a 1 kHz servo will stutter: allow real-time priority, stop other programs, or use a "
                             "machine that is not virtual"
                           : "";
    return {.title = "timer",
            .findings = {{.name = "lateness median", .value = lateness[lateness.size() / 2], .unit = "us"},
                         {.name = "lateness p99", .value = p99, .unit = "us", .hint = hint},
                         {.name = "lateness worst", .value = lateness.back(), .unit = "us"}}};
}

} // namespace filasofia::app
