#pragma once

#include "apps/filasofia/bench/contact_run.h"
#include "filasofia/runtime/timing.h"

#include <string>
#include <vector>

/// The cost table of `bench contact`, measured one scene at a time.
namespace filasofia::app {

/// The amount of measurement.
struct ContactEffort {
    int repetitions = 5; ///< [-]
    int steps = 150;     ///< [-] per repetition; the runs take turns, and each continues where it stopped
};

/// The steps of one run.
struct ContactTimes {
    int threads = 1;
    bool contacts = true;                ///< if false, the same bodies pass through each other
    std::vector<double> steps = {};      ///< [s]
    std::vector<double> detections = {}; ///< [s] per step: finding the contacts
    std::vector<double> responses = {};  ///< [s] per step: everything else
    std::vector<double> medians = {};    ///< [s] per repetition
    std::vector<double> others = {};     ///< [-] cores used by other programs, per repetition
    double iterations = 0.0;             ///< [-] mean
    std::uint32_t flags = 0;             ///< the union over all steps, also those before counting starts
    int flagged = 0;                     ///< [-] counted steps with a flag

    [[nodiscard]] runtime::Spread step() const { return runtime::spreadOf(steps); }
};

struct ContactCell {
    ContactScene scene = {};
    int elements = 0;
    std::vector<ContactTimes> runs = {};          ///< with one thread; contact-free with one thread; with all threads
    std::vector<double> found = {}, pushing = {}; ///< [-] per counted step
    std::vector<double> rounds = {}, forces = {}; ///< [-]; [N] the sum of all contacts' normal forces
    double penetration = 0.0;                     ///< [m] the deepest of all steps
    std::vector<double> mismatches = {};          ///< [-] per counted step

    [[nodiscard]] const ContactTimes& alone() const { return runs[0]; }
    [[nodiscard]] const ContactTimes& free() const { return runs[1]; }
    /// [-] time of a step / time of a contact-free step, over the repetitions
    [[nodiscard]] runtime::Spread overFree() const;
    [[nodiscard]] std::string label() const { return scene.label(); }
};

ContactCell timeContact(const ContactScene& scene, const ContactEffort& effort);

} // namespace filasofia::app
