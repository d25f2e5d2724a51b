#include "filasofia/engine/piercing/embed.h"

#include "filasofia/engine/body/elements.h"

#include "engine/stage.h"

namespace embed_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

Vec3 placeOf(const std::vector<NodeWeight>& point, const std::vector<Vec3>& x)
{
    Vec3 sum;
    for (const NodeWeight& each : point) sum += each.weight * x[static_cast<std::size_t>(each.node)];
    return sum;
}

} // namespace

TEST_CASE("a place in deformed tissue is found near the last one, and its nodes and weights give it back")
{
    Stage stage;
    stage.add(freeBody(boxMesh({6, 6, 6}, {0.06, 0.06, 0.06}, 0.2)));
    stage.step(1e-3);
    std::vector<Vec3> x = stage.soft().x;
    for (Vec3& each : x) each = {each.x + 0.3 * each.y, each.y, 1.2 * each.z - 0.1 * each.x}; // sheared
    const SoftModel& model = stage.model();
    std::mt19937 random(3);
    std::uniform_int_distribution<std::size_t> any(0, elementCount(model) - 1);
    for (int i = 0; i < 200; ++i) {
        const auto& nodes = elementNodes(model, any(random));
        std::vector<NodeWeight> from;
        for (int node : nodes) from.push_back({node, 0.25});
        const Vec3 wanted = placeOf(from, x) + randomVec3(random, 4e-3);
        const auto found = embed(wanted, from, model, x);
        // Brute force: whether any element holds the place.
        bool inside = false;
        for (std::size_t e = 0; e < elementCount(model); ++e) {
            const auto& t = elementNodes(model, e);
            const auto at = [&](int k) { return x[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
            const double v = geometry::signedVolume(at(0), at(1), at(2), at(3));
            inside = inside || (geometry::signedVolume(wanted, at(1), at(2), at(3)) >= 0 &&
                                geometry::signedVolume(at(0), wanted, at(2), at(3)) >= 0 &&
                                geometry::signedVolume(at(0), at(1), wanted, at(3)) >= 0 &&
                                geometry::signedVolume(at(0), at(1), at(2), wanted) >= 0 && v > 0);
        }
        CHECK(found.has_value() == inside);
        if (found) CHECK(length(placeOf(*found, x) - wanted) < 1e-8);
    }
}

TEST_CASE("a place outside tissue is in no element, and the nearest one is on the surface")
{
    Stage stage;
    stage.add(freeBody(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02})));
    stage.step(1e-3);
    const SoftModel& model = stage.model();
    const std::vector<Vec3>& x = stage.soft().x;
    const std::vector<NodeWeight> near{{0, 1.0}};
    CHECK_FALSE(embed({0.011, -0.001, 0.011}, near, model, x));
    const auto moved = embedNearest({0.011, -0.001, 0.011}, near, model, x);
    REQUIRE(moved);
    CHECK(placeOf(*moved, x).y == Approx(0.0).margin(1e-12));
    double sum = 0.0;
    for (const NodeWeight& each : *moved) {
        CHECK(each.weight > 0.0);
        sum += each.weight;
    }
    CHECK(sum == Approx(1.0));
}

} // namespace embed_test
