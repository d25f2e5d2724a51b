#include "filasofia/engine/contact/islands.h"

namespace islands_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

BodyPoint soft(std::size_t body)
{
    BodyPoint point;
    point.of = BodyPoint::Of::Soft;
    point.body = body;
    point.add(0, 1.0);
    return point;
}
BodyPoint rigid(std::size_t element)
{
    BodyPoint point;
    point.of = BodyPoint::Of::Rigid;
    point.body = element;
    return point;
}
Constraint between(const BodyPoint& a, const BodyPoint& b)
{
    Constraint constraint;
    constraint.sides = {a, b};
    return constraint;
}

} // namespace

TEST_CASE("bodies connected by constraints form one island, in the order of their first bodies")
{
    RigidPlan plan(3);
    plan[0].dynamic = plan[1].dynamic = true; // the third is kinematic
    const std::vector<Constraint> constraints{between(soft(3), rigid(1)),  between(soft(0), rigid(2)),
                                              between(soft(2), rigid(2)),  between(rigid(1), soft(0)),
                                              between(rigid(2), rigid(0)), between(soft(2), BodyPoint{})};
    const std::vector<Island> islands = findIslands(4, plan, constraints);
    REQUIRE(islands.size() == 3);
    CHECK(islands[0].soft == std::vector<std::size_t>{0, 3});
    CHECK(islands[0].rigid == std::vector<std::size_t>{1});
    CHECK(islands[0].constraints == std::vector<std::size_t>{0, 1, 3});
    CHECK(islands[1].soft == std::vector<std::size_t>{2}); // a kinematic element connects nothing
    CHECK(islands[1].constraints == std::vector<std::size_t>{2, 5});
    CHECK(islands[2].rigid == std::vector<std::size_t>{0});
    CHECK(islands[2].constraints == std::vector<std::size_t>{4});
}

TEST_CASE("constraints between elements that cannot move belong to no island")
{
    const RigidPlan plan(2);
    const std::vector<Constraint> constraints{between(rigid(0), rigid(1)), between(rigid(0), BodyPoint{})};
    CHECK(findIslands(0, plan, constraints).empty());
    CHECK(findIslands(0, {}, {}).empty());
}

} // namespace islands_test
