#pragma once

#include "bench/peers/problem.h"

namespace filasofia::peers {

/// How Bullet is used. The defaults are an example's settings, unchanged.
struct BulletSetting {
    bool implicitElasticity = true;    ///< false: elastic forces are explicit, and only damping is solved for
    bool massPreconditioner = false;   ///< fill the preconditioner that Bullet allocates but leaves empty
    bool rotationsOfStepStart = false; ///< rotations as in our equations: exact, and those at the start of the step
    int newtonIterations = 0;          ///< [-]; 0 for Bullet's own (1)
    /// [-] squared tolerance of conjugate gradients; 0 for Bullet's own (1.2e-7 in single precision)
    double tolerance = 0.0;
    int maxIterations = 0; ///< [-] iteration limit of conjugate gradients; 0 for Bullet's own (300)
};

/// "single" or "double", depending on how Bullet was built.
const char* bulletPrecision();
/// For example 3.24.
double bulletVersion();

/// btDeformableMultiBodyDynamicsWorld with one btSoftBody of tetrahedra and nothing to collide with.
Run runBullet(const Problem& problem, const BulletSetting& def);

} // namespace filasofia::peers
