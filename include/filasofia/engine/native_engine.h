#pragma once

#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/physics_engine.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace filasofia::engine {

struct NativeEngineDef {
    double period = 1e-3; ///< [s], in (0, 10]: the step that solvers prepare for. Others only take more iterations.
    std::optional<int> threads = {}; ///< [-], in [1, 256], at work within one step; not given: the cores but one, up to
                                     ///< 8. The same bits whatever their number.
    physics::ContactMethod contact = physics::ExactContact{}; ///< how bodies that touch push each other
};
constexpr auto fields(const NativeEngineDef*)
{
    using T = NativeEngineDef;
    return describe("NativeEngineDef",
                    field("period", &T::period, "s", openClosed(0, 10), "the step that solvers prepare for"),
                    field("threads", &T::threads, "-", closed(1, 256), "at work within one step"),
                    field("contact", &T::contact, "how bodies that touch push each other"));
}

/// The native engine: corotational elements and springs, explicit and implicit Euler, conjugate gradients and Cholesky.
/// Throws an Error naming the field that is out of its range.
std::unique_ptr<physics::PhysicsEngine> makeNativeEngine(const NativeEngineDef& def = {});

/// The instruction sets for which the inner loops are compiled and which this machine has, the best and used one first:
/// "AVX3" (AVX-512), "AVX2", "SSE4", "NEON", "EMU128" (plain code).
std::vector<std::string> simdTargets();

} // namespace filasofia::engine
