#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/surface/bleeding.h"
#include "filasofia/surface/burning.h"

#include <string>

/// What the layers of surfaces do to the bodies below, and reach of them.
namespace filasofia::runtime {

/// [m] The length over which a steady temperature in the layer falls by a factor of e, but no more than heat spreads in
/// a minute: if little is lost, the steady state is far from what a burn sees.
double spreadOf(const surface::BurningDef& def);

/// What heat that has denatured a share of some tetrahedra does to them.
physics::SetTissue changeOf(BodyId id, const surface::HeatedTissueDef& def, surface::HeatedPart part);

/// Throws an Error that begins with `object` if the engine cannot change the tissue of a body.
void checkTissue(BodyId id, const physics::BodyDef& body, const physics::PhysicsEngine& engine,
                 const std::string& object);

/// Whether an injury reaches a node of the surface, as it was or as it is now.
bool reaches(const surface::Injure& injure, const surface::Bleeding& layer, const frame::SoftBodyFrame& body);

} // namespace filasofia::runtime
