#pragma once

#include "apps/filasofia/bench/contact_run.h"
#include "filasofia/runtime/timing.h"

#include <string>
#include <vector>

/// What the cost table of `bench contact` measures, one scene at a time.
namespace filasofia::app {

/// How much is measured.
struct ContactEffort {
    int repetitions = 5; ///< [-]
    int steps = 150;     ///< [-], of each repetition: the runs take turns, and go on where they were
};

/// The steps of one run.
struct ContactTimes {
    int threads = 1;
    bool contacts = true;                ///< else the same bodies going through each other
    std::vector<double> steps = {};      ///< [s]
    std::vector<double> detections = {}; ///< [s] of each: finding who touches whom
    std::vector<double> responses = {};  ///< [s] of each: all the rest
    std::vector<double> medians = {};    ///< [s] per repetition
    std::vector<double> others = {};     ///< [-] cores that other programs took, per repetition
    double iterations = 0.0;             ///< [-] mean
    std::uint32_t flags = 0;             ///< of all steps, also those before the count
    int flagged = 0;                     ///< [-] counted steps with a flag

    [[nodiscard]] runtime::Spread step() const { return runtime::spreadOf(steps); }
};

struct ContactCell {
    ContactScene scene = {};
    int elements = 0;
    std::vector<ContactTimes> runs = {};          ///< one thread; contact-free with one thread; all threads
    std::vector<double> found = {}, pushing = {}; ///< [-] per counted step
    std::vector<double> rounds = {}, forces = {}; ///< [-]; [N] the sum of all contacts' normal forces
    double penetration = 0.0;                     ///< [m] the deepest of all steps
    std::vector<double> mismatches = {};          ///< [-] per counted step

    [[nodiscard]] const ContactTimes& alone() const { return runs[0]; }
    [[nodiscard]] const ContactTimes& free() const { return runs[1]; }
    [[nodiscard]] runtime::Spread overFree() const; ///< [-] step by contact-free step, over the repetitions
    [[nodiscard]] std::string label() const { return scene.body + ", " + scene.name; }
};

ContactCell timeContact(const ContactScene& scene, const ContactEffort& effort);

} // namespace filasofia::app
