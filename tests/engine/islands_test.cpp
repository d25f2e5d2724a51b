#include "filasofia/engine/contact/islands.h"

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
Link link(const BodyPoint& a, const BodyPoint& b)
{
    Link made;
    made.sides = {a, b};
    return made;
}

} // namespace

TEST_CASE("bodies that links tie together are one island, in the order of their first bodies")
{
    Model model;
    scene.soft.resize(4);
    RigidPlan plan(3);
    plan[0].dynamic = plan[1].dynamic = true; // the third goes where it is told
    const std::vector<Link> links{link(soft(3), rigid(1)), link(soft(0), rigid(2)),  link(soft(2), rigid(2)),
                                  link(rigid(1), soft(0)), link(rigid(2), rigid(0)), link(soft(2), BodyPoint{})};
    const std::vector<Island> islands = findIslands(scene, plan, links);
    REQUIRE(islands.size() == 3);
    CHECK(islands[0].soft == std::vector<std::size_t>{0, 3});
    CHECK(islands[0].rigid == std::vector<std::size_t>{1});
    CHECK(islands[0].links == std::vector<std::size_t>{0, 1, 3});
    CHECK(islands[1].soft == std::vector<std::size_t>{2}); // what is told ties nothing together
    CHECK(islands[1].links == std::vector<std::size_t>{2, 5});
    CHECK(islands[2].rigid == std::vector<std::size_t>{0});
    CHECK(islands[2].links == std::vector<std::size_t>{4});
}

TEST_CASE("links between what cannot move are in no island")
{
    const Model model;
    const RigidPlan plan(2);
    CHECK(findIslands(scene, plan, {link(rigid(0), rigid(1)), link(rigid(0), BodyPoint{})}).empty());
    CHECK(findIslands(scene, {}, {}).empty());
}
