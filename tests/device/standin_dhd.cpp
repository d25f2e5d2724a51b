// Stands in for Force Dimension's libdhd: the same C functions, as far as the driver uses them.
#include "device/standin.h"

#include <chrono>
#include <limits>
#include <mutex>
#include <thread>

namespace {

std::mutex mutex;
Standin state;

bool works(int id) { return id >= 0 && id < 2 && state.open[id] && state.connected[id] && !state.failing[id]; }

void blockIfAsked()
{
    int wait = 0;
    {
        const std::lock_guard lock(mutex);
        std::swap(wait, state.blockMilliseconds);
    }
    if (wait > 0) std::this_thread::sleep_for(std::chrono::milliseconds(wait));
}

} // namespace

extern "C" {

void standin(void (*with)(Standin&, void*), void* what)
{
    const std::lock_guard lock(mutex);
    with(state, what);
}

int dhdGetDeviceCount()
{
    const std::lock_guard lock(mutex);
    return state.devices;
}
int dhdOpenID(char id)
{
    const std::lock_guard lock(mutex);
    if (id < 0 || id >= state.devices || !state.connected[int(id)]) return -1;
    state.open[int(id)] = true;
    ++state.opened;
    return id;
}
int dhdClose(char id)
{
    const std::lock_guard lock(mutex);
    state.open[int(id)] = false;
    ++state.closed;
    return 0;
}
int dhdEnableForce(unsigned char on, char id)
{
    const std::lock_guard lock(mutex);
    state.forceEnabled[int(id)] = on != 0;
    return 0;
}
int dhdGetStatus(int* out, char id)
{
    const std::lock_guard lock(mutex);
    for (int i = 0; i < 17; ++i) out[i] = 0;
    out[1] = state.connected[int(id)] ? 1 : 0;
    out[3] = state.calibrated[int(id)] ? 0 : 1;
    return state.open[int(id)] ? 0 : -1;
}
int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double m[3][3], char id)
{
    blockIfAsked();
    const std::lock_guard lock(mutex);
    if (!works(id)) return -1;
    const double* p = state.position[int(id)];
    const bool bad = state.garbage[int(id)];
    *x = bad ? std::numeric_limits<double>::quiet_NaN() : p[0];
    *y = bad ? 1e300 : p[1];
    *z = p[2];
    // A quarter turn about the vendor's z, which points up.
    const double turn[3][3] = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) m[r][c] = turn[r][c];
    return 0;
}
int dhdGetLinearVelocity(double* x, double* y, double* z, char id)
{
    const std::lock_guard lock(mutex);
    if (!works(id)) return -1;
    *x = state.velocity[int(id)][0];
    *y = state.velocity[int(id)][1];
    *z = state.velocity[int(id)][2];
    return 1; // a remark, not an error
}
int dhdGetAngularVelocityRad(double*, double*, double*, char) { return -1; } // this model cannot measure it
unsigned int dhdGetButtonMask(char id)
{
    const std::lock_guard lock(mutex);
    return state.buttons[int(id)];
}
bool dhdHasWrist(char) { return true; }
bool dhdHasActiveWrist(char id) { return id == 0; }
int dhdSetForceAndTorque(double fx, double fy, double fz, double tx, double ty, double tz, char id)
{
    const std::lock_guard lock(mutex);
    if (!works(id)) return -1;
    const double f[3] = {fx, fy, fz}, t[3] = {tx, ty, tz};
    for (int k = 0; k < 3; ++k) {
        state.force[int(id)][k] = f[k];
        state.torque[int(id)][k] = t[k];
    }
    return 2; // a motor at its limit
}
int dhdSetForce(double fx, double fy, double fz, char id) { return dhdSetForceAndTorque(fx, fy, fz, 0, 0, 0, id); }
const char* dhdErrorGetLastStr() { return "communication\nerror"; }
}
