// Stands in for 3D Systems' libHD: the same C functions, and a servo loop of its own, like the library's.
#include "device/standin.h"

#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <thread>

namespace {

struct Error {
    unsigned int code;
    int internal;
    unsigned int handle;
};
using Callback = unsigned int (*)(void*);

constexpr unsigned int kNone = 0xFFFFFFFF;

std::mutex mutex;
Standin state;
std::atomic<unsigned int> current = 0;
std::map<unsigned long, std::pair<Callback, void*>> tasks; // guarded by the mutex
unsigned long lastTask = 0;
std::atomic<bool> running = false;
std::thread servo;
thread_local unsigned int lastError = 0;
double pending[2][3] = {};

void run()
{
    auto next = std::chrono::steady_clock::now();
    while (running) {
        std::map<unsigned long, std::pair<Callback, void*>> now;
        int wait = 0;
        {
            const std::lock_guard lock(mutex);
            now = tasks;
            std::swap(wait, state.blockMilliseconds);
        }
        if (wait > 0) std::this_thread::sleep_for(std::chrono::milliseconds(wait));
        for (const auto& [id, task] : now) task.first(task.second);
        next = std::max(next + std::chrono::milliseconds(1), std::chrono::steady_clock::now());
        std::this_thread::sleep_until(next);
    }
}

} // namespace

extern "C" {

void standin(void (*with)(Standin&, void*), void* what)
{
    const std::lock_guard lock(mutex);
    with(state, what);
}

unsigned int hdInitDevice(const char* name)
{
    const std::lock_guard lock(mutex);
    const int id = name && std::strcmp(name, "Left Device") == 0 ? 1 : 0;
    const bool known = !name || id == 1 || std::strcmp(name, "Default Device") == 0;
    if (!known || running || id >= state.devices || !state.connected[id]) { // not while its loop runs
        lastError = 0x0302;
        return kNone;
    }
    state.open[id] = true;
    ++state.opened;
    return current = static_cast<unsigned int>(id);
}
void hdDisableDevice(unsigned int id)
{
    const std::lock_guard lock(mutex);
    state.open[id] = false;
    ++state.closed;
    for (double& f : state.force[id]) f = 0.0;
}
void hdMakeCurrentDevice(unsigned int id) { current = id; }
void hdBeginFrame(unsigned int) {}
void hdEndFrame(unsigned int id)
{
    const std::lock_guard lock(mutex);
    if (!state.connected[id]) {
        lastError = 0x0302;
        return;
    }
    if (state.failing[id]) {
        lastError = 0x0200; // the motors are warm
        return;
    }
    for (int k = 0; k < 3; ++k) state.force[id][k] = pending[id][k];
}
Error hdGetError()
{
    const Error error{lastError, 0, current};
    lastError = 0;
    return error;
}
const char* hdGetErrorString(unsigned int code)
{
    return code == 0x0302 ? "Communication error" : code == 0x0200 ? "Motors are warm" : "Something else";
}
void hdEnable(unsigned int what)
{
    const std::lock_guard lock(mutex);
    if (what == 0x4000) state.forceEnabled[current] = true;
}
void hdGetDoublev(unsigned int what, double* out)
{
    const std::lock_guard lock(mutex);
    const double* p = state.position[current];
    const double* v = state.velocity[current];
    if (what == 0x2052) { // a quarter turn about y, column-major, in millimetres
        const double bad = std::numeric_limits<double>::quiet_NaN();
        const double m[16] = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1e3 * p[0], 1e3 * p[1], 1e3 * p[2], 1};
        for (int i = 0; i < 16; ++i) out[i] = state.garbage[current] ? bad : m[i];
    } else if (what == 0x2051) {
        for (int k = 0; k < 3; ++k) out[k] = 1e3 * v[k];
    } else if (what == 0x2053) {
        out[0] = out[1] = 0.0;
        out[2] = 0.5;
    } else if (what == 0x2603) {
        out[0] = 7.9;
    }
}
void hdGetIntegerv(unsigned int what, int* out)
{
    const std::lock_guard lock(mutex);
    *out = what == 0x2000 ? static_cast<int>(state.buttons[current]) : 2;
}
void hdSetDoublev(unsigned int what, const double* in)
{
    const std::lock_guard lock(mutex);
    if (what != 0x2700) return;
    for (int k = 0; k < 3; ++k) pending[current][k] = in[k];
}
unsigned int hdCheckCalibration()
{
    const std::lock_guard lock(mutex);
    return state.calibrated[current] ? 0x5000 : 0x5002;
}
void hdUpdateCalibration(unsigned int) {}
void hdStartScheduler()
{
    if (!running.exchange(true)) servo = std::thread(run);
}
void hdStopScheduler()
{
    running = false;
    if (servo.joinable()) servo.join();
}
unsigned long hdScheduleAsynchronous(Callback callback, void* self, unsigned short)
{
    const std::lock_guard lock(mutex);
    tasks[++lastTask] = {callback, self};
    return lastTask;
}
void hdUnschedule(unsigned long task)
{
    const std::lock_guard lock(mutex);
    tasks.erase(task);
}
}
