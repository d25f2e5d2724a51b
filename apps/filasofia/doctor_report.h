#pragma once

#include <iosfwd>
#include <string>
#include <variant>
#include <vector>

namespace filasofia::app {

/// One line of doctor's report.
struct Finding {
    std::string name; ///< "git revision"; in JSON git_revision
    std::variant<std::string, bool, long long, double> value = {};
    std::string unit = {}; ///< if the value is a number
    std::string hint = {}; ///< how to fix a shortcoming; empty if there is none
};

struct Section {
    std::string title; ///< one word
    std::vector<Finding> findings;
};

using DoctorReport = std::vector<Section>;

// One function per section. None of them throws.
Section examineProgram();    ///< version, revision, compiler
Section examineProcessor();  ///< model, cores, vector instructions, memory
Section examineGpu();        ///< the device that draws without a window
Section examineDisplay();    ///< whether a window can open
Section examineDevices();    ///< joysticks, 3D mouse, haptic device libraries
Section examineScheduling(); ///< whether threads may get real-time priority
Section examineTimer();      ///< how late a thread wakes on a 1 ms grid; takes 0.2 s
Section examineLibraries();  ///< third-party versions that this program was compiled with

void writeTable(const DoctorReport& report, std::ostream& out);
void writeJson(const DoctorReport& report, std::ostream& out);

} // namespace filasofia::app
