#include "verification/verification.h"

namespace gradient_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

double elementEnergy(const FemElement& element, const Corners& x) { return energyOf(Corotational{}, element, x); }

/// The largest error of the element's forces against central differences of its energy, relative to the forces, over
/// random deformations; if `inverted`, only over those that invert it.
double worstForceError(bool inverted)
{
    std::mt19937 random(21);
    double worst = 0.0;
    for (int k = 0; k < 200; ++k) {
        Corners rest, x;
        const FemElement element = randomElement(random, rest);
        Mat3 f;
        do f = 1.5 * randomMat3(random, 1.0);
        while ((determinant(f) < 0.0) != inverted || std::abs(determinant(f)) < 0.1);
        for (std::size_t i = 0; i < 4; ++i) x[i] = f * rest[i];
        const Corners forces = elementForces(element, x);
        double error = 0.0, size = 0.0;
        for (std::size_t i = 0; i < 4; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                constexpr double h = 1e-5;
                Corners ahead = x, behind = x;
                ahead[i][axis] += h;
                behind[i][axis] -= h;
                const double slope = (elementEnergy(element, ahead) - elementEnergy(element, behind)) / (2 * h);
                error += (forces[i][axis] + slope) * (forces[i][axis] + slope);
                size += slope * slope;
            }
        worst = std::max(worst, std::sqrt(error / size));
    }
    return worst;
}

} // namespace

TEST_CASE("an element's force is the negative gradient of its energy")
{
    verify("force against -dW/dx, large deformations", worstForceError(false), 1e-6);
    verify("force against -dW/dx, inverted elements", worstForceError(true), 1e-6);
}

TEST_CASE("a spring's force is the negative gradient of its energy, and its stiffness the gradient of its force")
{
    std::mt19937 random(22);
    double force = 0.0, stiffness = 0.0;
    for (int k = 0; k < 500; ++k) {
        const Spring spring{.nodes = {0, 1}, .restLength = 1.0, .stiffness = 300.0};
        const Vec3 a = randomVec3(random, 1.0);
        Vec3 b = randomVec3(random, 3.0);
        while (distance(a, b) < 0.3) b = randomVec3(random, 3.0);
        const Vec3 f = springForce(spring, a, b);
        const Mat3 exact = springStiffness(spring, a, b);
        Vec3 slope;
        Mat3 difference;
        for (int axis = 0; axis < 3; ++axis) {
            constexpr double h = 1e-5;
            Vec3 ahead = a, behind = a;
            ahead[axis] += h;
            behind[axis] -= h;
            slope[axis] = (springEnergy(spring, ahead, b) - springEnergy(spring, behind, b)) / (2 * h);
            difference[axis] = (springForce(spring, behind, b) - springForce(spring, ahead, b)) / (2 * h);
        }
        force = std::max(force, length(f + slope) / length(slope));
        if (distance(a, b) > 1.0) // in compression the transverse part is left out on purpose
            stiffness = std::max(stiffness, frobeniusNorm(exact - difference) / frobeniusNorm(exact));
    }
    verify("spring force against -dW/dx", force, 1e-6);
    verify("spring stiffness in extension against -df/dx", stiffness, 1e-6);
}

} // namespace gradient_test
