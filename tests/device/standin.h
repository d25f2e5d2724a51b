#pragma once

/// What tests set in the stand-ins for the vendors' libraries, and read from them. Two devices each.
struct Standin {
    int devices = 2;
    bool connected[2] = {true, true};
    bool calibrated[2] = {true, true};
    bool failing[2] = {false, false}; ///< calls return errors although the device is connected
    bool garbage[2] = {false, false}; ///< NaN and 1e300 instead of positions
    int blockMilliseconds = 0;        ///< applies once, to the next reading
    double position[2][3] = {};       ///< [m], along the vendor's axes
    double velocity[2][3] = {};       ///< [m/s]
    unsigned int buttons[2] = {};
    double force[2][3] = {};  ///< [N], the last force set
    double torque[2][3] = {}; ///< [N m]
    bool open[2] = {};
    bool forceEnabled[2] = {};
    int opened = 0, closed = 0;
};
using StandinFunction = void (*)(void (*)(Standin&, void*), void*); ///< calls back with the state, while it is locked
