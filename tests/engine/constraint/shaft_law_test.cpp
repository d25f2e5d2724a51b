#include "filasofia/engine/constraint/constraint.h"

#include "engine/meshes.h"

namespace shaft_law_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("the impulse along a shaft is bounded by dry friction, across it by nothing")
{
    Constraint shaft;
    shaft.kind = ConstraintKind::Shaft;
    shaft.maxImpulse = 4.0;
    const Projected sticks = project(shaft, {-3.9, 0.0, 4.0});
    CHECK(sticks.impulse == Vec3{-3.9, 0.0, 4.0});
    CHECK(sticks.slip == 1.0);
    CHECK(sticks.active);
    const Projected slides = project(shaft, {-8.0, 0.0, 4.0});
    CHECK(slides.impulse == Vec3{-4.0, 0.0, 4.0});
    CHECK(slides.slip == 0.0);
    CHECK(slides.active);
    CHECK(sharesOf(shaft, sticks) == Vec3{1.0, 1.0, 1.0});
    CHECK(sharesOf(shaft, slides) == Vec3{0.0, 1.0, 1.0}); // it slides on with the same force
    CHECK(linearised(shaft, slides, {-9.0, 1.0, 5.0}) == Vec3{-4.0, 1.0, 5.0});
    CHECK(linearised(shaft, sticks, {-9.0, 1.0, 5.0}) == Vec3{-9.0, 1.0, 5.0});
    CHECK(project(shaft, {1.0, 7.0, 0.0}, 0.25).impulse == Vec3{0.25, 7.0, 0.0}); // a cone of fixed radius

    shaft.maxImpulse = 0.0; // without friction it only guides
    const Projected free = project(shaft, {5.0, 1.0, -1.0});
    CHECK(free.impulse == Vec3{0.0, 1.0, -1.0});
    CHECK(free.active);
}

TEST_CASE("the legs of a clip are springs along their normal, both ways, and weaker ones across it")
{
    Constraint leg;
    leg.kind = ConstraintKind::ClipLeg;
    leg.across = 0.25;
    CHECK(leg.bilateral());
    for (const double along : {-3.0, 2.0}) {
        const Projected state = project(leg, {along, 7.0, -5.0});
        CHECK(state.impulse == Vec3{along, 1.75, -1.25});
        CHECK(state.active);
        CHECK(sharesOf(leg, state) == Vec3{1.0, 0.25, 0.25});
        CHECK(linearised(leg, state, {4.0, 1.0, 2.0}) == Vec3{4.0, 0.25, 0.5});
    }
}

TEST_CASE("a tip pushes with what cuts at most, and never pulls")
{
    Constraint tip;
    tip.kind = ConstraintKind::Tip;
    tip.maxImpulse = 2.0;
    CHECK(project(tip, {-1.0, 3.0, 0.0}).impulse == Vec3{});
    CHECK(project(tip, {1.5, 3.0, 0.0}).impulse == Vec3{1.5, 0.0, 0.0});
    CHECK(project(tip, {5.0, 0.0, 0.0}).impulse == Vec3{2.0, 0.0, 0.0});
}

} // namespace shaft_law_test
