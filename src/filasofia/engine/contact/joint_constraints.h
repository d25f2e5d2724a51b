#pragma once

#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/constraint/body_point.h"

/// Stops and dry friction of free joints, as links of a joint with space: solved together with contacts.
namespace filasofia::engine {

struct Coupling;

/// What a link of a joint is about, beside its link.
struct JointLink {
    enum class What { LowerStop, UpperStop, Dry };
    What what = What::Dry;
    std::size_t articulation = 0; ///< place among the plans
    int joint = 0;
    double arm = 1.0; ///< [m] the link's velocity is the joint's times this; 1 of a prismatic one
};

/// After the contacts' and the attachments' links.
void linkJoints(const Model& model, double dt, const State& state, Coupling& coupling);

/// What joints bore in the step, and where their next solve starts.
void keepJoints(const Model& model, double dt, const Coupling& coupling, State& state);

} // namespace filasofia::engine
