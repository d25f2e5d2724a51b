#include "filasofia/engine/integration/rigid.h"

namespace filasofia::engine {
namespace {

Quat turn(Vec3 rotation) { return axisAngle(rotation, length(rotation)); }

/// The left Jacobian C of exp: exp(x + dx) = exp(C dx) exp(x) to first order.
Mat3 changeOfTurn(Vec3 x)
{
    const double angle = length(x), square = angle * angle;
    const bool small = angle < 1e-3;
    const double a = small ? 0.5 - square / 24.0 : (1.0 - std::cos(angle)) / square;
    const double b = small ? 1.0 / 6.0 - square / 120.0 : (angle - std::sin(angle)) / (square * angle);
    const Mat3 skew = crossMatrix(x);
    return Mat3::identity() + a * skew + b * (skew * skew);
}

/// Solves for the angular velocity W of a step, in the body's axes, from the angular momentum L in these axes at its
/// start:
///     J W = exp(-h/2 W) L
/// by Newton's method, each correction halved until it reduces the residual. If a body turns by several radians in a
/// step, the iteration may not converge. The momentum then has a wrong direction but the right magnitude, as the result
/// is J^-1 times a rotated L. So no step is too long to be stable.
Vec3 midpointVelocity(const Mat3& inertia, const Mat3& inverseInertia, Vec3 momentum, double dt)
{
    constexpr int iterations = 20, halvings = 6;
    constexpr double enough = 1e-14; // relative to the momentum
    struct Guess {
        Vec3 w, middle, residual;
    };
    const auto guess = [&](Vec3 w) -> Guess {
        const Vec3 middle = rotate(turn(-0.5 * dt * w), momentum);
        return {w, middle, inertia * w - middle};
    };
    Guess best = guess(inverseInertia * momentum);
    bool better = true;
    for (int i = 0; i < iterations && better; ++i) {
        if (!(lengthSquared(best.residual) > enough * enough * lengthSquared(momentum))) break;
        const Mat3 slope = inertia - 0.5 * dt * (crossMatrix(best.middle) * changeOfTurn(-0.5 * dt * best.w));
        Vec3 correction = inverse(slope) * best.residual;
        better = false;
        for (int k = 0; k < halvings && !better; ++k, correction *= 0.5) {
            const Guess next = guess(best.w - correction);
            better = lengthSquared(next.residual) < lengthSquared(best.residual);
            if (better) best = next;
        }
    }
    return inverseInertia * best.middle;
}

} // namespace

RigidChange freeChange(const RigidLoad& load, Quat orientation, Vec3 velocity, Vec3 angularVelocity, double dt)
{
    const Vec3 acceleration = load.force / load.mass + load.gravity;
    const Vec3 v = (velocity + dt * acceleration) / (1.0 + dt * load.linearDamping);

    const Quat toBody = conjugate(orientation);
    const Vec3 before = load.inertia * rotate(toBody, angularVelocity);
    const Vec3 momentum = (before + dt * rotate(toBody, load.torque)) / (1.0 + dt * load.angularDamping);
    const Vec3 w = rotate(orientation, midpointVelocity(load.inertia, inverse(load.inertia), momentum, dt));
    return {v - velocity, w - angularVelocity};
}

Vec3 turnedVelocity(const Mat3& inertia, Quat orientation, Vec3 angularVelocity, double dt)
{
    const Vec3 w = rotate(conjugate(orientation), angularVelocity); // constant during the step
    return rotate(orientation, inverse(inertia) * rotate(turn(-0.5 * dt * w), inertia * w));
}

Pose moved(const Pose& pose, Vec3 centre, Vec3 velocity, Vec3 angularVelocity, double dt)
{
    const Quat orientation = normalized(turn(dt * angularVelocity) * pose.orientation);
    return {transform(pose, centre) + dt * velocity - rotate(orientation, centre), orientation};
}

RigidChange velocitiesBetween(const Pose& from, const Pose& to, double dt)
{
    const Vec3 rotation = rotationVector(to.orientation * conjugate(from.orientation));
    return {(to.position - from.position) / dt, rotation / dt};
}

} // namespace filasofia::engine
