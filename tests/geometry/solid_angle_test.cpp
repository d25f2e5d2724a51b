#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/solid_angle.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace solid_angle_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

constexpr double kPi = std::numbers::pi;

double around(Vec3 point, const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += solidAngle(point, mesh.vertices[static_cast<std::size_t>(a)], mesh.vertices[static_cast<std::size_t>(b)],
                          mesh.vertices[static_cast<std::size_t>(c)]);
    return sum;
}

} // namespace

TEST_CASE("three axes span an eighth of the sphere, and half of it if the point is on the triangle")
{
    const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    CHECK(solidAngle({}, x, y, z) == Approx(0.5 * kPi).epsilon(1e-14));
    CHECK(solidAngle({}, x, z, y) == Approx(-0.5 * kPi).epsilon(1e-14)); // from the front
    CHECK(solidAngle({}, 3.0 * x, 0.1 * y, 20.0 * z) == Approx(0.5 * kPi).epsilon(1e-14));
    CHECK(std::abs(solidAngle({0.3, 0.3, 0}, {}, x, y)) == Approx(2.0 * kPi).epsilon(1e-12));
    CHECK(solidAngle({2, 2, 0}, {}, x, y) == Approx(0.0).margin(1e-12)); // in its plane, beside it
    CHECK(solidAngle(x, x, y, z) == 0.0);                                // a corner of it
}

TEST_CASE("a square is seen under the angle of the closed form, far away as area over distance squared")
{
    const double half = 0.5, height = 2.0;
    const Vec3 a{-half, -half, height}, b{half, -half, height}, c{half, half, height}, d{-half, half, height};
    const double exact = 4.0 * std::asin(half * half / (half * half + height * height));
    CHECK(solidAngle({}, a, b, c) + solidAngle({}, a, c, d) == Approx(exact).epsilon(1e-13));

    const Vec3 far{0, 0, -1000};
    CHECK(solidAngle(far, {}, {1, 0, 0}, {0, 1, 0}) == Approx(0.5e-6).epsilon(1e-5));
}

TEST_CASE("a closed surface goes around what is inside once, and around what is outside not at all")
{
    const auto box = shapes::box({2, 2, 2}, {3, 2, 1});
    for (const Vec3 inside : {Vec3{}, Vec3{0.9, -0.7, 0.99}}) CHECK(around(inside, *box) == Approx(4.0 * kPi));
    for (const Vec3 outside : {Vec3{1.01, 0, 0}, Vec3{5, 6, 7}})
        CHECK(around(outside, *box) == Approx(0).margin(1e-12));

    // At a corner the three faces that do not meet there remain, an eighth of the sphere.
    CHECK(around({1, 1, 1}, *shapes::box({2, 2, 2})) == Approx(0.5 * kPi).epsilon(1e-13));
}

} // namespace solid_angle_test
