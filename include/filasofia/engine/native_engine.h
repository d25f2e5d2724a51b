#pragma once

#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/physics_engine.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace filasofia::engine {

/// The parameters of the native engine.
struct NativeEngineDef {
    /// [s], in (0, 10]: the step that solvers prepare for. Other steps only take more iterations.
    double period = 1e-3;
    std::optional<int> threads = {}; ///< [-], in [1, 256]: number of threads within one step. Not given: one less than
                                     ///< the cores, in [1, 8]. The results are bit-identical for any number.
    physics::ContactMethod contact = physics::ExactContact{}; ///< how contacts are solved
};
constexpr auto fields(const NativeEngineDef*)
{
    using T = NativeEngineDef;
    return describe("NativeEngineDef",
                    field("period", &T::period, "s", openClosed(0, 10), "the step that solvers prepare for"),
                    field("threads", &T::threads, "-", closed(1, 256), "number of threads within one step"),
                    field("contact", &T::contact, "how contacts are solved"));
}

/// Creates the native engine: corotational elements and springs, explicit and implicit Euler, conjugate gradients and
/// Cholesky. Throws an Error that names the field if a field is out of its range.
std::unique_ptr<physics::PhysicsEngine> makeNativeEngine(const NativeEngineDef& def = {});

/// The instruction sets for which the inner loops are compiled and which this machine supports. The first is the best
/// and is the one in use: "AVX3" (AVX-512), "AVX2", "SSE4", "NEON", "EMU128" (plain code).
std::vector<std::string> simdTargets();

} // namespace filasofia::engine
