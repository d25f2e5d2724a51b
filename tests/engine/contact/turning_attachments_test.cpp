#include "filasofia/engine/contact/turning_attachments.h"

#include "filasofia/math/quat.h"

namespace turning_attachments_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kDt = 1e-3; ///< [s]

/// Tissue that is welded to a free body, which a step turns by 1 rad about z.
Coupling weldedToTurning()
{
    Coupling coupling;
    coupling.rigid.resize(1);
    coupling.rigid[0].dynamic = true;
    coupling.rigid[0].change.angular = {0, 0, 1.0 / kDt};
    Constraint weld;
    weld.sides[0].of = BodyPoint::Of::Soft;
    weld.sides[0].body = 3;
    weld.sides[1].of = BodyPoint::Of::Rigid;
    weld.sides[1].body = 0;
    weld.sides[1].position = {5e-3, 0, 0};
    coupling.constraints = {weld};
    coupling.weldCount = 1;
    return coupling;
}

} // namespace

TEST_CASE("a weld to a body that turns foresees the chord of its arc, whole or in part, and what is far off is told")
{
    Coupling coupling = weldedToTurning();
    CHECK(heldElsewhere(kDt, coupling) == std::vector<std::size_t>{3});
    REQUIRE(foreseeTurns(kDt, 1.0, coupling));
    const BodyPoint& point = coupling.constraints[0].sides[1];
    const Vec3 arm = point.position, chord = rotate(axisAngle({0, 0, 1}, 1.0), arm) - arm;
    CHECK(distance(cross(Vec3{0, 0, 1}, arm + point.shift), chord) < 1e-15);
    CHECK(heldElsewhere(kDt, coupling).empty());
    CHECK_FALSE(foreseeTurns(kDt, 1.0, coupling));

    Coupling partly = weldedToTurning();
    REQUIRE(foreseeTurns(kDt, 0.5, partly));
    CHECK(distance(partly.constraints[0].sides[1].shift, 0.5 * point.shift) < 1e-15);
    CHECK(heldElsewhere(kDt, partly) == std::vector<std::size_t>{3});
    for (int i = 0; i < 8 && foreseeTurns(kDt, 0.5, partly); ++i) CHECK(i < 7); // a half of what is left, each time
    CHECK(heldElsewhere(kDt, partly).empty());

    coupling = weldedToTurning();
    coupling.rigid[0].dynamic = false;
    CHECK(heldElsewhere(kDt, coupling).empty());
    CHECK_FALSE(foreseeTurns(kDt, 1.0, coupling));
}

} // namespace turning_attachments_test
