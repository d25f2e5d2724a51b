#include "filasofia/geometry/shapes.h"
#include "filasofia/mapping/transfer.h"

namespace transfer_test {

using namespace filasofia;
using namespace filasofia::mapping;

namespace {

geometry::TriangleMesh square() { return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}}; }

} // namespace

TEST_CASE("vertices that stay keep their values to the bit, doubled ones too, whatever their new numbers")
{
    const geometry::TriangleMesh old = square();
    // Cut along the diagonal, whose two ends exist twice.
    const geometry::TriangleMesh fresh{
        {{0, 1, 0}, {1, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}}, {{2, 3, 1}, {5, 4, 0}}, {}};
    CHECK(carry(transferBetween(old, fresh), std::vector<double>{0.1, 0.2, 0.3, 0.4}) ==
          std::vector<double>{0.4, 0.3, 0.1, 0.2, 0.3, 0.1});
}

TEST_CASE("a new vertex on the surface gets the mean, one inside the tissue gets a default value")
{
    geometry::TriangleMesh fresh = square();
    fresh.vertices.push_back({0.25, 0.0, 0.0});
    fresh.vertices.push_back({0.5, 0.5, 0.0});
    fresh.vertices.push_back({0.5, 0.5, -0.1});
    const auto values = carry(transferBetween(square(), fresh), std::vector<double>{0.0, 1.0, 0.5, 0.5});
    CHECK(values[4] == Approx(0.25));
    CHECK(values[5] == Approx(0.25));
    CHECK(values[6] == 0.0);
}

TEST_CASE("a surface gives itself every value, and an old one without triangles gives none")
{
    const auto sphere = geometry::shapes::sphere(0.05, 5);
    std::vector<double> values;
    for (std::size_t i = 0; i < sphere->vertices.size(); ++i) values.push_back(0.001 * static_cast<double>(i));
    CHECK(carry(transferBetween(*sphere, *sphere), values) == values);
    CHECK(carry(transferBetween({}, square()), std::vector<double>{}) == std::vector<double>(4, 0.0));
}

} // namespace transfer_test
