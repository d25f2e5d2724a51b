#include "filasofia/core/real_time.h"

#include <pthread.h>
#include <sched.h>

namespace filasofia {

bool requestRealTime(int above)
{
    cpu_set_t usable; // not all cores of the machine, but those that this process may use
    if (sched_getaffinity(0, sizeof usable, &usable) != 0 || CPU_COUNT(&usable) < 2) return false;
    const sched_param priority{.sched_priority = sched_get_priority_min(SCHED_FIFO) + above};
    return pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
}

} // namespace filasofia
