#pragma once

#include "apps/hysteroscopy/patient.h"

/// What all cases have in common.
namespace hysteroscopy {

/// What a case file may change in every case.
struct Rules {
    bool guided = false;
    double timeLimit = 600;         ///< [s]
    double warning = 3;             ///< [N]
    double perforation = 8;         ///< [N]
    double strength = 15;           ///< [N]
    double pressure = 80 * 133.322; ///< [Pa], 80 mmHg are usual
    double uterusModulus = 12e3;    ///< [Pa]
};
constexpr auto fields(const Rules*)
{
    using namespace filasofia;
    return describe(
        "Rules", field("guided", &Rules::guided, "arrow and instructions from the start"),
        field("timeLimit", &Rules::timeLimit, "s", closed(10, 7200), "for the whole task"),
        field("warning", &Rules::warning, "N", closed(0.01, 100), "force above which the force bar warns"),
        field("perforation", &Rules::perforation, "N", closed(0.1, 100), "force on the uterus that perforates it"),
        field("strength", &Rules::strength, "N", closed(0.1, 100), "force at which the hands advance no further"),
        field("pressure", &Rules::pressure, "Pa", closed(0, 20e3), "of the fluid at the start"),
        field("uterusModulus", &Rules::uterusModulus, "Pa", closed(1e3, 1e6), "Young's modulus of the uterus"));
}
/// [N] At the end of the force bar.
constexpr double fullScale(const Rules& rules) { return std::max(5.0, 1.5 * rules.warning); }
inline constexpr Rules kRules[] = {{.guided = true}, {}, {.timeLimit = 300, .warning = 2}}; ///< by difficulty
inline const std::vector<std::string> kDifficulties = {"easy", "normal", "hard"};

filasofia::SimulationDef theatre();
filasofia::EndoscopeDef scopeOf(std::vector<int> groups);
/// Hands that push an instrument out of the scope by `mostReach` [m].
filasofia::prefab::ScopeHandsDef handsOf(const filasofia::Training& training, double mostReach);
/// What a session observes, but for its steps: both instruments and the events that all cases have.
filasofia::MetricTrackerDef observedIn(const filasofia::Training& training, const filasofia::TrackedBody& tool,
                                       filasofia::BodyId scope, const std::string& target);
/// Where the end of a scope is.
filasofia::Vec3 tipOf(const filasofia::frame::Frame& now, filasofia::BodyId scope);
/// The steps with which every case begins; `find` says what is to be found.
std::vector<filasofia::TaskStep> wayIn(const Patient& patient, filasofia::BodyId scope, const char* find);
std::string millilitres(double volume);

} // namespace hysteroscopy
