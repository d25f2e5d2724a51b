#include "apps/filasofia/bench/load.h"

#include "filasofia/runtime/timing.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace filasofia::app {
namespace {

/// [s] processor time of all cores used by all programs, including the time that the host took: proc_stat(5), in ticks.
double allCores()
{
    std::ifstream stat("/proc/stat");
    std::string word;
    double user = 0, nice = 0, system = 0, idle = 0, disk = 0, irq = 0, softIrq = 0, stolen = 0;
    stat >> word >> user >> nice >> system >> idle >> disk >> irq >> softIrq >> stolen;
    return (user + nice + system + irq + softIrq + stolen) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

} // namespace

double secondsOf(clockid_t clock)
{
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

OthersLoad::OthersLoad()
    : wall_(secondsOf(CLOCK_MONOTONIC)), own_(secondsOf(CLOCK_PROCESS_CPUTIME_ID)), all_(allCores())
{
}

double OthersLoad::cores() const
{
    const double wall = secondsOf(CLOCK_MONOTONIC) - wall_, own = secondsOf(CLOCK_PROCESS_CPUTIME_ID) - own_;
    return wall > 0.0 ? std::max(0.0, (allCores() - all_ - own) / wall) : 0.0;
}

double coreRoundTrip()
{
    constexpr int kStop = -1, kBatch = 20;
    // [s] In total. A single trip may take long, because both threads may have to share a core.
    constexpr double kLongest = 0.02;
    struct alignas(256) Word { // fills a cache line and the one that is fetched with it
        std::atomic<int> value = 0;
        int awaitOtherThan(int old) const
        {
            for (int spins = 0;; ++spins) {
                if (const int now = value.load(std::memory_order_acquire); now != old) return now;
                if (spins > 1000) std::this_thread::yield();
            }
        }
    };
    Word there, back;
    std::jthread other([&] {
        for (int seen = 0; (seen = there.awaitOtherThan(seen)) != kStop;)
            back.value.store(seen, std::memory_order_release);
    });
    std::vector<double> trips; // [s] mean of each batch
    const double begun = secondsOf(CLOCK_MONOTONIC);
    int made = 0;
    for (double last = begun; last < begun + kLongest;) {
        for (int i = 0; i < kBatch; ++i, ++made) {
            there.value.store(made + 1, std::memory_order_release);
            back.awaitOtherThan(made);
        }
        const double now = secondsOf(CLOCK_MONOTONIC);
        trips.push_back((now - last) / kBatch);
        last = now;
    }
    there.value.store(kStop, std::memory_order_release);
    return runtime::spreadOf(trips).median;
}

} // namespace filasofia::app
