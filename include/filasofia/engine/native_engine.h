#pragma once

#include <memory>

namespace filasofia::physics {
class PhysicsEngine;
}

namespace filasofia::engine {

/// The native engine: corotational elements and springs, explicit and implicit Euler, Cholesky and conjugate gradients.
std::unique_ptr<physics::PhysicsEngine> makeNativeEngine();

} // namespace filasofia::engine
