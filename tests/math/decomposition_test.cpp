#include "filasofia/math/polar.h"
#include "filasofia/math/svd.h"

#include <random>

namespace decomposition_test {

using namespace filasofia;

namespace {

Mat3 randomMatrix(std::mt19937& random, double size = 1.0)
{
    std::uniform_real_distribution<double> number(-size, size);
    Mat3 m;
    for (Vec3& row : m.row) row = {number(random), number(random), number(random)};
    return m;
}

Quat randomRotation(std::mt19937& random)
{
    std::normal_distribution<double> number;
    return normalized(Quat{number(random), number(random), number(random), number(random)});
}

double orthogonalityError(const Mat3& r) { return frobeniusNorm(transposeTimes(r, r) - Mat3::identity()); }

void checkSvd(const Mat3& a)
{
    const Svd s = svd(a);
    const double scale = frobeniusNorm(a) + 1e-300;
    CHECK(orthogonalityError(s.u) < 1e-13);
    CHECK(orthogonalityError(s.v) < 1e-13);
    CHECK(determinant(s.u) == Approx(1.0).margin(1e-13));
    CHECK(determinant(s.v) == Approx(1.0).margin(1e-13));
    CHECK(s.sigma.x >= s.sigma.y);
    CHECK(s.sigma.y >= std::abs(s.sigma.z));
    CHECK(frobeniusNorm(s.u * Mat3::diagonal(s.sigma) * transpose(s.v) - a) < 1e-13 * scale);
}

} // namespace

TEST_CASE("the singular value decomposition gives the matrix back, with two rotations")
{
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) checkSvd(randomMatrix(random));
    for (double size : {1e-150, 1e-8, 1e8, 1e150}) checkSvd(randomMatrix(random, size));
}

TEST_CASE("the singular value decomposition takes flat, thin, zero and inverted matrices")
{
    std::mt19937 random(2);
    for (int i = 0; i < 200; ++i) {
        const Mat3 u = toMat3(randomRotation(random)), v = toMat3(randomRotation(random));
        for (Vec3 sigma : {Vec3{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, -1}, {2, 1, -0.5}, {1, 1e-13, 0}})
            checkSvd(u * Mat3::diagonal(sigma) * v);
    }
}

TEST_CASE("the polar rotation of R S is R, whatever the guess")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> stretch(0.2, 3.0);
    for (int i = 0; i < 2000; ++i) {
        const Quat r = randomRotation(random);
        const Mat3 v = toMat3(randomRotation(random));
        const Mat3 s = v * Mat3::diagonal({stretch(random), stretch(random), stretch(random)}) * transpose(v);
        const Quat found = polarRotation(toMat3(r) * s, i % 2 ? randomRotation(random) : Quat{});
        CHECK(std::abs(dot(found, r)) == Approx(1.0).margin(1e-13));
    }
}

TEST_CASE("the polar rotation of an inverted matrix is the nearest rotation")
{
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
        const Mat3 f =
            toMat3(randomRotation(random)) * Mat3::diagonal({1.2, 0.9, -0.4}) * toMat3(randomRotation(random));
        const double best = contract(toMat3(polarRotation(f, randomRotation(random))), f);
        CHECK(best == Approx(1.2 + 0.9 - 0.4).epsilon(1e-12));
        for (int k = 0; k < 20; ++k) CHECK(contract(toMat3(randomRotation(random)), f) <= best + 1e-12);
    }
}

TEST_CASE("the polar rotation of a zero or a point-like matrix is some rotation")
{
    for (const Mat3& f : {Mat3{}, 1e-200 * Mat3::identity(), outer({1, 0, 0}, {0, 1, 0}), -1.0 * Mat3::identity()}) {
        const Quat q = polarRotation(f, {});
        CHECK(isFinite(q));
        CHECK(dot(q, q) == Approx(1.0));
    }
}

} // namespace decomposition_test
