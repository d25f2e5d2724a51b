#pragma once

#include "filasofia/physics/registry.h"

/// What is checked of joints, outside the engine.
namespace filasofia::physics {

inline bool isArticulated(const RigidBodyDef& def) { return !def.articulation.joints.empty() || def.articulation.to; }

/// Throws an Error beginning with `object` for what one number's range cannot say: no axis, loops, links that two
/// joints move, limits the wrong way round.
void checkArticulation(const RigidBodyDef& def, const std::string& object);

/// What is to take its base along must be there, and go where it is told.
void checkBase(const Registry& registry, const RigidBodyDef& def);
/// Of an articulated body only the base can be set, and only where nothing takes it along.
void checkNotALink(const Registry& registry, const RigidBodyDef& def, int element);
void checkCommand(const RigidBodyDef& def, const std::vector<bool>& takesForce, const SetJoint& set);

/// Per joint: can a force command it.
std::vector<bool> forceable(const BodyDef& def);

/// In defs.cpp.
void check(const GivenInertia& given, const std::string& object);
RigidInertia inertiaOf(const GivenInertia& given);

} // namespace filasofia::physics
