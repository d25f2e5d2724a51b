#pragma once

#include "filasofia/engine/rupture/elements_at.h"
#include "filasofia/sofa/scene_state.h"

#include "filasofia/physics/step.h"

namespace filasofia::sofaengine {

/// Cuts bodies along the paths of the blades in the step just made, tears what stress tears, and parts the points of
/// attachments that blades came near to. The edits are those of the native engine's room rupture; bodies that are
/// edited are made anew. `before`: where bodies were at the start of the step of dt [s].
void ruptureBodies(const SceneMotion& before, double dt, SofaScene& scene, physics::StepReport& report);

enum class Removal {
    Done,
    NoPiece, ///< there is no such piece, or it is all that is left
    Failed   ///< SOFA could not make what is left; the log says why, and the piece stays
};
/// Removes a piece. Attachments that hold its nodes go.
Removal removePieceOf(BodyId body, int piece, SofaScene& scene);
/// Removes pieces that have fallen out of the scene. They would fall for ever.
void removeLostPieces(SofaScene& scene, physics::StepReport& report);

/// The elements of all bodies that a rigid body's blades could cut.
engine::ElementsAtBlade elementsAtBlades(const RigidNode& tool, const SofaScene& scene);
/// Draws blades that are switched off once they are out of tissue, and counts those that were pushed on into it.
void followSheaths(SofaScene& scene, physics::TopologyReport& report);

} // namespace filasofia::sofaengine
