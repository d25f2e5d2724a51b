#pragma once

#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/physics_engine.h"

#include <memory>

/// SOFA (sofa-framework.org) as a physics engine: the bodies of Defs become nodes with SOFA's components. Its namespace
/// is not that of its folder: a program that says `using namespace filasofia` needs `sofa` for SOFA's own.
/// docs/guide/sofa.md says what maps to what.
namespace filasofia::sofaengine {

struct SofaEngineDef {
    double period = 1e-3;                                     ///< [s], in (0, 10]: the step that solvers prepare for
    physics::ContactMethod contact = physics::ExactContact{}; ///< how contacts are solved
};
constexpr auto fields(const SofaEngineDef*)
{
    using T = SofaEngineDef;
    return describe("SofaEngineDef",
                    field("period", &T::period, "s", openClosed(0, 10), "the step that solvers prepare for"),
                    field("contact", &T::contact, "how contacts are solved"));
}

/// Whether this program was built with SOFA.
bool isBuiltIn();

/// Creates the engine. Throws an Error that says how to get it if this program was built without SOFA, or that names a
/// field which is out of its range. Engines of one process share SOFA's global state, so they step one after the other,
/// whatever threads they are stepped by.
std::unique_ptr<physics::PhysicsEngine> makeSofaEngine(const SofaEngineDef& def = {});

} // namespace filasofia::sofaengine
