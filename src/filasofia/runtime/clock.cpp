#include "filasofia/runtime/clock.h"

#include <cerrno>
#include <ctime>

namespace filasofia::runtime {

Clock steadyClock()
{
    return {.now =
                [] {
                    timespec t{};
                    clock_gettime(CLOCK_MONOTONIC, &t);
                    return Nanoseconds{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
                },
            .sleepUntil =
                [](Nanoseconds time) {
                    const timespec t{.tv_sec = time / 1'000'000'000, .tv_nsec = time % 1'000'000'000};
                    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
                    }
                }};
}

} // namespace filasofia::runtime
