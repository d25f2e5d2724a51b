#include "physics/fake_engine.h"

#include "filasofia/geometry/shapes.h"

namespace needle_def_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

RigidBodyDef needle(const NeedleDef& def)
{
    return {.name = "needle", .mesh = geometry::shapes::box({1, 1, 1}), .collision = {{}}, .needle = def};
}

SoftBodyDef tissue(const PunctureDef& def)
{
    return {.name = "skin", .mesh = geometry::shapes::block({1, 1, 1}), .collision = {{}}, .puncture = def};
}

} // namespace

TEST_CASE("a needle is a line of points that are apart, on an element that exists, held at not too many points")
{
    check(needle({.line = {{0, 0, 0}, {0, 0.03, 0}}}));
    CHECK_THROWS_WITH(check(needle({})), "rigid body 'needle': needle.line must have at least 2 points, got 0");
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 0, 0}}})),
                      "rigid body 'needle': needle.line[0] and needle.line[1] must be apart, their distance is 0 m");
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 0.04, 0}, {0, 0, 0}}})),
                      "rigid body 'needle': the line must turn by less than 168 degrees at needle.line[1], turns by "
                      "180 degrees");
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 1, 0}}})),
                      "rigid body 'needle': needle.spacing must leave at most 500 points, got 0.001 m on 1 m");
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 0.1, 0}}, .radius = 0.0})),
                      "rigid body 'needle': needle.radius must be > 0 m, got 0");
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 0.1, 0}}, .element = 1})),
                      Catch::StartsWith("rigid body 'needle': needle.element must be"));
    CHECK_THROWS_WITH(check(needle({.line = {{0, 0, 0}, {0, 1e-3, 0}}})),
                      "rigid body 'needle': needle.spacing must be < the line's length, 0.001 m, got 0.001");
    RodBodyDef ring{.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    ring.closed = ring.needle = true;
    CHECK_THROWS_WITH(check(ring), "rod 'rod': needle must be false if closed: a ring has no tip");
}

TEST_CASE("tissue resists needles if it has tetrahedra and a stiffness, and sticks at least as much as it slides")
{
    check(tissue({}));
    CHECK_THROWS_WITH(check(tissue({.friction = 5.0, .staticFriction = 4.0})),
                      "soft body 'skin': puncture.staticFriction must be >= friction, 5 N/m, got 4");
    SoftBodyDef springs = tissue({});
    springs.material = MassSpringMaterial{};
    CHECK_THROWS_WITH(check(springs), "soft body 'skin': puncture.stiffness must be given with a MassSpringMaterial, "
                                      "which has no Young's modulus");
    springs.puncture->stiffness = 1e5;
    check(springs);
    SoftBodyDef shell{.name = "skin", .mesh = geometry::shapes::sheet(1, 1), .material = ShellMaterial{}};
    shell.puncture = PunctureDef{};
    shell.collision = {{}};
    CHECK_THROWS_WITH(check(shell),
                      "soft body 'skin': puncture must be none with a ShellMaterial: needles pierce tetrahedra only");
}

TEST_CASE("needles and what they pierce need collision models: without contact nothing would be pierced")
{
    SoftBodyDef skin = tissue({});
    skin.collision = {};
    CHECK_THROWS_WITH(check(skin), "soft body 'skin': collision must have an entry if puncture is given: a needle that "
                                   "touches nothing pierces nothing");
    skin.collision = {{.cutting = true}};
    CHECK_THROWS_WITH(check(skin), "soft body 'skin': collision must have an entry without cutting if puncture is "
                                   "given: only blades meet one that has it, and a needle that touches nothing pierces "
                                   "nothing");
    skin.collision.push_back({});
    check(skin);
    RigidBodyDef blunt = needle({.line = {{0, 0, 0}, {0, 0.03, 0}}});
    blunt.collision = {};
    CHECK_THROWS_WITH(check(blunt), "rigid body 'needle': collision must have an entry of element 0, which has the "
                                    "needle: a needle that touches nothing pierces nothing");
    RodBodyDef rod{.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}};
    rod.needle = true;
    CHECK_THROWS_WITH(check(rod), "rod 'rod': collision must be given if needle is true: a needle that touches nothing "
                                  "pierces nothing");
    rod.collision = RodCollision{};
    check(rod);
}

} // namespace needle_def_test
