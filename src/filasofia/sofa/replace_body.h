#pragma once

#include "filasofia/sofa/follow_cut.h"
#include "filasofia/sofa/node_removal.h"
#include "filasofia/sofa/sofa_scene.h"

namespace filasofia::sofaengine {

/// A body as plain data, and all ties that hold it.
BodyDraft draftOf(const SoftNode& body, const SofaScene& scene);

/// Puts another node into the place of a soft body, as the draft says, with the draft's ties for those that hold it.
/// SOFA's components know one topology each; making them anew is what works for all of them. `cuts`: the mesh that it
/// has then. Components that a user has added to the node are lost, which the log says. Throws what SOFA throws: the
/// body is as it was then.
void replaceBody(BodyDraft draft, std::unique_ptr<SoftCuts> cuts, SofaScene& scene, BodyId id);

/// Makes a body that may be cut whole again, at rest.
void mendBody(BodyId id, SofaScene& scene);

} // namespace filasofia::sofaengine
