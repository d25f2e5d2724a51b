#pragma once

#include "apps/hysteroscopy/patient.h"

/// What all cases have in common.
namespace hysteroscopy {

struct Difficulty {
    const char* name;
    bool guided;    ///< arrow and instructions from the start
    double minutes; ///< [min] time limit of the whole task
    double warning; ///< [N] the force bar warns above it
};
inline constexpr Difficulty kDifficulties[] = {{"easy", true, 10, 3}, {"normal", false, 10, 3}, {"hard", false, 5, 2}};
inline constexpr double kPerforation = 8; ///< [N] force on the uterus that counts as a perforation

filasofia::SimulationDef theatre();
filasofia::EndoscopeDef scopeOf(std::vector<int> groups);
/// Hands that push an instrument out of the scope by `mostReach` [m].
filasofia::prefab::ScopeHandsDef handsOf(const filasofia::Training& training, double mostReach);
/// What a session observes, but for its steps: both instruments and the events that all cases have.
filasofia::MetricTrackerDef observedIn(const filasofia::Training& training, const filasofia::TrackedBody& tool,
                                       filasofia::BodyId scope, const std::string& target);
std::string millilitres(double volume);

} // namespace hysteroscopy
