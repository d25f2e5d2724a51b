#pragma once

#include "filasofia/core/text.h"
#include "filasofia/engine/scene/each_body.h"
#include "filasofia/math/polar.h"

#include "engine/elastic/laws.h"
#include "engine/stage.h"

#include <iostream>

namespace filasofia::engine {

/// Prints a measured value in the form that docs/lab/verification.md uses, and checks it against its bound.
inline void verify(const std::string& what, double value, double bound)
{
    std::cout << "verification: " << what << ": " << text(value) << " (bound " << text(bound) << ")\n";
    CHECK(value <= bound);
}

inline void verifyWithin(const std::string& what, double value, double low, double high)
{
    std::cout << "verification: " << what << ": " << text(value) << " (bound " << text(low) << " to " << text(high)
              << ")\n";
    CHECK(value >= low);
    CHECK(value <= high);
}

/// Prints a value that has no bound.
inline void tell(const std::string& what, double value)
{
    std::cout << "verification: " << what << ": " << text(value) << " (bound none)\n";
}

/// Whether all threads work inside this body, as opposed to one thread per body (engine/scene/each_body.h).
inline bool threadsShare(Stage& stage, int threads, std::size_t body = 0)
{
    const WorkerPool pool(threads);
    return sizeOf(stage.model(body)) > sharedBeyond(stage.world.scene(), pool);
}

/// An element with a random shape of about unit size.
inline FemElement randomElement(std::mt19937& random, Corners& rest)
{
    double volume = 0.0;
    while (!(volume > 0.02))
        for (volume = 0.0; Vec3 & x : rest) {
            x = randomVec3(random, 1.0);
            volume = geometry::signedVolume(rest[0], rest[1], rest[2], rest[3]);
        }
    return {.nodes = {0, 1, 2, 3},
            .gradients = shapeGradients(rest),
            .volume = volume,
            .youngModulus = 1e4,
            .poissonRatio = 0.4};
}

/// The nearest rotation, found without an initial guess.
inline Mat3 nearestRotation(const Mat3& f) { return toMat3(polarRotation(f, {})); }

inline Corners elementForces(const FemElement& element, const Corners& x)
{
    return forcesOf(physics::Corotational{}, element, x);
}

/// Finds where a body of elements is at rest under `loads` [N]; pinned nodes stay where x has them. Newton's method on
/// the forces with the step's tangent, each step solved by Cholesky, until a correction is computed from a residual
/// below `tolerance` times the first.
inline void solveStatic(const SoftModel& model, std::span<const Vec3> loads, std::vector<Vec3>& x,
                        double tolerance = 1e-13)
{
    SoftModel still = model;
    still.integrator = physics::ImplicitEuler{};
    still.solver = physics::Cholesky{};
    still.rayleigh = {.mass = 0.0, .stiffness = 0.0};
    AssembledSystem system(still);
    SoftState state = stateAtStart(still);
    state.x = x;
    std::vector<Vec3> dx(x.size());
    double first = 0.0;
    for (int iteration = 0; iteration < 300; ++iteration) {
        // With steps of 1 s, without inertia, damping and velocity, the step's equation is K dx = f.
        assembleMatrix(still, loads, 1.0, 0.0, state, system);
        double size = 0.0;
        for (const Vec3& each : system.rightHandSide) size += lengthSquared(each);
        if (iteration == 0) first = size;
        system.solver->solve(system.matrix, system.rightHandSide, dx);
        for (std::size_t i = 0; i < x.size(); ++i) state.x[i] += dx[i];
        if (iteration > 0 && size < tolerance * tolerance * first) break;
    }
    x = state.x;
}

} // namespace filasofia::engine
