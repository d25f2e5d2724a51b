#include "filasofia/visual/transform.h"

#include "filasofia/core/error.h"

namespace transform_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

bool near(const Pose& a, const Pose& b)
{
    return distance(a.position, b.position) < 1e-12 && std::abs(dot(a.orientation, b.orientation)) > 1 - 1e-12;
}

const Pose kTurned{{1, 2, 3}, axisAngle({0, 0, 1}, 0.7)};
const Pose kTilted{{-0.5, 0.1, 0}, axisAngle({1, 0.3, 0}, -1.1)};

} // namespace

TEST_CASE("a child's world pose is its parent's times its own")
{
    Transform a("a"), b("b"), c("c");
    a.setPose(kTurned);
    b.setPose(kTilted);
    c.setPose({{0, 0, 1}, {}});
    b.attachTo(a);
    c.attachTo(b);
    CHECK(near(b.worldPose(), kTurned * kTilted));
    CHECK(near(c.worldPose(), kTurned * kTilted * c.pose()));
    CHECK(c.parent() == &b);
    REQUIRE(b.children().size() == 1);
    CHECK(b.children()[0] == &c);
}

TEST_CASE("a detached child stays where it is")
{
    Transform a("a"), b("b");
    a.setPose(kTurned);
    b.setPose(kTilted);
    b.attachTo(a);
    const Pose before = b.worldPose();
    b.detach();
    CHECK(near(b.worldPose(), before));
    CHECK(b.parent() == nullptr);
    CHECK(a.children().empty());
    b.detach(); // a second detach() has no effect
    CHECK(near(b.worldPose(), before));
}

TEST_CASE("the children of a dead parent stay where they are")
{
    Transform child("child");
    Pose before;
    {
        Transform grandparent("grandparent"), parent("parent");
        grandparent.setPose(kTilted);
        parent.setPose(kTurned);
        parent.attachTo(grandparent);
        child.setPose(kTilted);
        child.attachTo(parent);
        before = child.worldPose();
    }
    CHECK(child.parent() == nullptr);
    CHECK(near(child.worldPose(), before));
}

TEST_CASE("a circle of parents is an error, and changes nothing")
{
    Transform a("alpha"), b("beta"), c("gamma");
    b.attachTo(a);
    c.attachTo(b);
    CHECK_THROWS_WITH(a.attachTo(c), Contains("alpha") && Contains("gamma"));
    CHECK_THROWS_AS(a.attachTo(a), Error);
    CHECK(a.parent() == nullptr);
    c.attachTo(a); // another parent makes no cycle
    CHECK(c.parent() == &a);
    CHECK(b.children().empty());
}

TEST_CASE("an invalid pose is an error")
{
    Transform a("alpha");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(a.setPose({{nan, 0, 0}, {}}), Contains("alpha"));
    CHECK_THROWS_AS(a.setPose({{}, {nan, 0, 0, 0}}), Error);
    CHECK_THROWS_AS(a.setPose({{}, {0, 0, 0, 0}}), Error);
    CHECK_THROWS_AS(a.setPose({{}, {2, 0, 0, 0}}), Error);
    CHECK(a.pose() == Pose{});
}

TEST_CASE("looking at a point turns -Z there and keeps +Y up")
{
    for (Vec3 eye : {Vec3{1, 2, 3}, Vec3{-4, 0.1, 2}, Vec3{0, 5, 0}, Vec3{0, -5, 0}, Vec3{0, 0, -1}}) {
        const Pose pose = lookAt(eye, {0.1, 0, 0.1});
        const Vec3 ahead = rotate(pose.orientation, {0, 0, -1});
        CHECK(distance(ahead, normalized(Vec3{0.1, 0, 0.1} - eye)) < 1e-9);
        CHECK(rotate(pose.orientation, {0, 1, 0}).y >= 0.0);
        CHECK(pose.position == eye);
    }
    const Pose straightDown = lookAt({0, 1, 0}, {0, 0, 0});
    CHECK(distance(rotate(straightDown.orientation, {0, 0, -1}), {0, -1, 0}) < 1e-12);
    CHECK_THROWS_AS(lookAt({1, 1, 1}, {1, 1, 1}), Error);
    CHECK_THROWS_AS(lookAt({1, 1, std::numeric_limits<double>::infinity()}, {}), Error);
}

} // namespace transform_test
