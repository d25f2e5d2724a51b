#include "verification/verification.h"

#include <Eigen/Dense>

namespace tangent_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// The 12 x 12 matrix of a linear map of corners; its columns are the images of the unit vectors.
template <class Map> Matrix12 matrixOf(Map&& map)
{
    Matrix12 m;
    for (int c = 0; c < 12; ++c) {
        Corners unit;
        unit[static_cast<std::size_t>(c / 3)][c % 3] = 1.0;
        const Corners image = map(unit);
        for (int r = 0; r < 12; ++r) m(r, c) = image[static_cast<std::size_t>(r / 3)][r % 3];
    }
    return m;
}

Matrix12 exactTangent(const FemElement& element, const Mat3& f)
{
    const Mat3 r = nearestRotation(f);
    return matrixOf([&](const Corners& dx) {
        return internalForces(element, exactCorotationalChange(lameOf(element), {f, r}, gradient(element, dx)));
    });
}

Matrix12 warpedTangent(const FemElement& element, const Mat3& f)
{
    const Mat3 r = nearestRotation(f);
    return matrixOf([&](const Corners& dx) { return stiffnessTimes(WarpedTangent{lameOf(element), r}, element, dx); });
}

Matrix12 differences(const FemElement& element, const Corners& x)
{
    return -matrixOf([&](const Corners& unit) {
        constexpr double h = 1e-6;
        Corners ahead = x, behind = x;
        for (std::size_t i = 0; i < 4; ++i) {
            ahead[i] += h * unit[i];
            behind[i] -= h * unit[i];
        }
        const Corners plus = elementForces(element, ahead), minus = elementForces(element, behind);
        Corners slope;
        for (std::size_t i = 0; i < 4; ++i) slope[i] = (plus[i] - minus[i]) / (2 * h);
        return slope;
    });
}

} // namespace

TEST_CASE("the exact tangent is the derivative of the forces")
{
    std::mt19937 random(31);
    double upright = 0.0, inverted = 0.0;
    for (int k = 0; k < 200; ++k) {
        Corners rest, x;
        const FemElement element = randomElement(random, rest);
        Mat3 f;
        do f = 1.5 * randomMat3(random, 1.0);
        while (std::abs(determinant(f)) < 0.2);
        const Mat3 s = transposeTimes(nearestRotation(f), f);
        // If the two smallest stretches nearly cancel, the nearest rotation itself is nearly discontinuous.
        if (determinant(trace(s) * Mat3::identity() - s) < 0.3) continue;
        for (std::size_t i = 0; i < 4; ++i) x[i] = f * rest[i];
        const Matrix12 exact = exactTangent(element, f);
        const double error = (exact - differences(element, x)).norm() / exact.norm();
        double& worst = determinant(f) > 0.0 ? upright : inverted;
        worst = std::max(worst, error);
    }
    CHECK(inverted > 0.0); // both kinds occurred
    verify("exact tangent against differences of the force", upright, 1e-6);
    verify("exact tangent against differences, inverted elements", inverted, 1e-6);
}

TEST_CASE("the warped tangent is positive semi-definite, and the six rigid motions are its null space")
{
    std::mt19937 random(32);
    double lowest = 0.0;
    for (int k = 0; k < 300; ++k) {
        Corners rest;
        const FemElement element = randomElement(random, rest);
        const Matrix12 warped = warpedTangent(element, 2.0 * randomMat3(random, 1.0));
        CHECK((warped - warped.transpose()).norm() < 1e-12 * warped.norm());
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Matrix12>(warped).eigenvalues();
        lowest = std::min(lowest, values[0] / values[11]);
        CHECK(values[5] < 1e-12 * values[11]);
        CHECK(values[6] > 1e-6 * values[11]);
    }
    verify("warped tangent, lowest eigenvalue below zero over the highest", -lowest, 1e-12);
}

TEST_CASE("in tension the warped tangent with its geometric part is never less than the exact one")
{
    std::mt19937 random(35);
    double lowest = 0.0, without = 0.0, bare = 0.0;
    int tense = 0;
    for (int k = 0; k < 1000; ++k) {
        Corners rest;
        FemElement element = randomElement(random, rest);
        element.poissonRatio = k % 2 == 0 ? 0.4 : 0.49;
        const Lame material = lame(element.youngModulus, element.poissonRatio);
        const Mat3 f = toMat3(randomRotation(random)) * (Mat3::identity() + randomMat3(random, 1.0));
        const Mat3 r = nearestRotation(f), s = transposeTimes(r, f);
        const double turning = geometricStiffness(material, {f, r});
        if (!(determinant(f) > 0.0 && trace(s) - 3.0 > kTense &&
              material.lambda * (trace(s) - 3.0) > 2.0 * material.mu)) {
            CHECK((turning == 0.0 || determinant(f) < 0.0));
            continue;
        }
        ++tense;
        const Matrix12 exact = exactTangent(element, f), warped = warpedTangent(element, f);
        const Matrix12 whole = matrixOf([&](const Corners& dx) {
            return stiffnessTimes(WarpedTangent{material, r, turning}, element, dx);
        });
        const auto least = [&](const Matrix12& m) {
            return Eigen::SelfAdjointEigenSolver<Matrix12>(m).eigenvalues()[0] / exact.norm();
        };
        lowest = std::min(lowest, least(whole - exact));
        without = std::min(without, least(warped - exact));
        bare = std::min(bare, least(whole));
    }
    CHECK(tense > 100);
    CHECK(without < -0.1); // the reason for the geometric part
    verify("tangent in tension minus the exact one, lowest eigenvalue below zero over the exact one", -lowest, 1e-12);
    verify("tangent in tension, lowest eigenvalue below zero over the exact one", -bare, 1e-12);
}

TEST_CASE("the warped tangent is the exact one at every rotated rest shape")
{
    std::mt19937 random(33);
    double worst = 0.0;
    for (int k = 0; k < 200; ++k) {
        Corners rest;
        const FemElement element = randomElement(random, rest);
        const Mat3 r = toMat3(randomRotation(random));
        const Matrix12 exact = exactTangent(element, r);
        worst = std::max(worst, (warpedTangent(element, r) - exact).norm() / exact.norm());
    }
    verify("warped against exact tangent at rotated rest", worst, 1e-10);
}

TEST_CASE("away from the rest shape the warped tangent is off by about the strain")
{
    std::mt19937 random(34);
    for (double size : {0.01, 0.05, 0.2, 0.5}) {
        double mean = 0.0;
        for (int k = 0; k < 200; ++k) {
            Corners rest;
            const FemElement element = randomElement(random, rest);
            const Mat3 f = toMat3(randomRotation(random)) * (Mat3::identity() + randomMat3(random, size));
            const Matrix12 exact = exactTangent(element, f);
            mean += (warpedTangent(element, f) - exact).norm() / exact.norm() / 200;
        }
        tell(text("warped against exact tangent, mean gap at random strain up to ", size), mean);
        CHECK(mean > 0.0);
        CHECK(mean < 10.0 * size); // first order in the strain
    }
}

} // namespace tangent_test
