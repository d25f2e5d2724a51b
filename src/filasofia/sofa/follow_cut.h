#pragma once

#include "filasofia/sofa/soft_cuts.h"
#include "filasofia/sofa/soft_node.h"
#include "filasofia/sofa/tie.h"

namespace filasofia::sofaengine {

/// A body in the making, as plain data: what an edit of its mesh makes of it.
struct BodyDraft {
    SoftPlan plan = {};
    SoftState state = {};
    SoftSettings settings = {};
    std::vector<TieState> ties = {}; ///< those that hold it
};

/// Brings everything that is kept about a body in line with one edit of its mesh: nodes, elements, masses, pins,
/// surface and state, and the points of attachments on it. Momentum is conserved. The mesh of `cuts` has the edit
/// already.
void followCut(const frame::TopologyEdit& edit, SoftCuts& cuts, BodyDraft& body);

/// Makes the body whole, as it was before its first edit and in its own place. Pins on nodes that are gone are gone.
void makeWhole(const SoftCuts& cuts, BodyDraft& body);

/// Lets go of what holds nodes of removed pieces, as the native engine does: makeWhole() brings back the pins of the
/// Def, but not those of commands.
void forgetGone(BodyDraft& body);

/// What the edit has parted: pieces, their masses and places, and whether pins hold them.
std::vector<physics::LoosePiece> loosePieces(const frame::TopologyEdit& edit, SoftCuts& cuts, const BodyDraft& body);

} // namespace filasofia::sofaengine
