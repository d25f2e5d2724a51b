#pragma once

#include "bench/peers/problem.h"

namespace filasofia::peers {

/// How Bullet is used. Its defaults: an example's settings, with nothing changed.
struct BulletSetting {
    bool implicitElasticity = true;    ///< false: elastic forces are explicit, only damping is solved for
    bool massPreconditioner = false;   ///< fill the preconditioner that Bullet makes but leaves empty
    bool rotationsOfStepStart = false; ///< elements turned as ours are: exactly, and as they were when the step began
    int newtonIterations = 0;          ///< [-]; 0: Bullet's own (1)
    double tolerance = 0.0;            ///< [-] of conjugate gradients, squared; 0: Bullet's own (1.2e-7 in single)
    int maxIterations = 0;             ///< [-] of conjugate gradients; 0: Bullet's own (300)
};

/// "single" or "double": how Bullet was built.
const char* bulletPrecision();
/// Such as 3.24.
double bulletVersion();

/// btDeformableMultiBodyDynamicsWorld with one btSoftBody of tetrahedra, nothing to collide with.
Run runBullet(const Problem& problem, const BulletSetting& def);

} // namespace filasofia::peers
