#include "filasofia/core/units.h"
#include "filasofia/math/pose.h"

namespace pose_test {

using namespace filasofia;

TEST_CASE("a rotation by its quaternion and by its matrix agree")
{
    const Quat q = axisAngle({1, 2, -3}, 73_deg);
    const Vec3 v{0.3, -0.7, 2.0};
    CHECK(distance(rotate(q, v), toMat3(q) * v) < 1e-15);
    CHECK(std::abs(dot(toQuat(toMat3(q)), q)) == Approx(1.0));
}

TEST_CASE("every branch of matrix to quaternion is right")
{
    for (Vec3 axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {-1, 2, 0.1}})
        for (double angle : {0.0, 0.1, 1.5, 3.0, std::numbers::pi, -2.5}) {
            const Quat q = axisAngle(axis, angle);
            CHECK(frobeniusNorm(toMat3(toQuat(toMat3(q))) - toMat3(q)) < 1e-14);
        }
}

TEST_CASE("the rotation vector undoes axis and angle")
{
    const Vec3 axis = normalized(Vec3{1, -2, 0.5});
    for (double angle : {1e-14, 1e-6, 0.3, 3.1}) {
        CHECK(distance(rotationVector(axisAngle(axis, angle)), angle * axis) < 1e-12 * angle + 1e-28);
    }
    CHECK(rotationVector(Quat{}) == Vec3{});
}

TEST_CASE("poses compose and invert")
{
    const Pose a{{1, 2, 3}, axisAngle({0, 1, 1}, 0.7)}, b{{-2, 0.5, 1}, axisAngle({1, 0, 1}, -1.1)};
    const Vec3 p{0.1, 0.2, 0.3};
    CHECK(distance(transform(a * b, p), transform(a, transform(b, p))) < 1e-15);
    CHECK(distance(transform(inverse(a), transform(a, p)), p) < 1e-15);
}

TEST_CASE("inverse matrix times matrix is the identity")
{
    const Mat3 a{{{2, 1, 0}, {0.3, -1, 4}, {1, 1, 1}}};
    CHECK(frobeniusNorm(inverse(a) * a - Mat3::identity()) < 1e-14);
}

} // namespace pose_test
