#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"
#include "geometry/sample_meshes.h"

#include <limits>

namespace bvh_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

std::vector<Box> randomBoxes(std::mt19937& random, int count, double size)
{
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
        const Vec3 low = randomPoint(random, -1, 1);
        boxes.push_back({low, low + randomPoint(random, 0, size)});
    }
    return boxes;
}

std::vector<int> overlappingByHand(std::span<const Box> boxes, const Box& query)
{
    std::vector<int> found;
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
        if (overlap(boxes[i], query)) found.push_back(i);
    return found;
}

// Triangles as primitives, as collision detection and picking use the tree.
struct Triangles {
    std::vector<std::array<Vec3, 3>> corners;

    Triangles(std::mt19937& random, int count)
    {
        for (int i = 0; i < count; ++i) {
            const Vec3 a = randomPoint(random, -1, 1);
            corners.push_back({a, a + randomPoint(random, -0.2, 0.2), a + randomPoint(random, -0.2, 0.2)});
        }
    }
    [[nodiscard]] std::vector<Box> boxes() const
    {
        std::vector<Box> all;
        for (auto [a, b, c] : corners) all.push_back(merged(merged(merged(Box{}, a), b), c));
        return all;
    }
    [[nodiscard]] double squaredDistance(int i, Vec3 p) const
    {
        return nearestOnTriangle(p, corners[i][0], corners[i][1], corners[i][2]).squaredDistance;
    }
    [[nodiscard]] double hit(int i, Vec3 origin, Vec3 direction) const
    {
        return rayTriangle(origin, direction, corners[i][0], corners[i][1], corners[i][2]);
    }
};

void checkAgainstBruteForce(const Bvh& tree, const Triangles& all, std::mt19937& random)
{
    const int count = static_cast<int>(all.corners.size());
    for (int i = 0; i < 200; ++i) {
        const Vec3 p = randomPoint(random, -2, 2), direction = randomPoint(random, -1, 1);
        Bvh::Found nearest, first;
        for (int t = 0; t < count; ++t) {
            if (const double d = all.squaredDistance(t, p); d < nearest.value) nearest = {t, d};
            if (const double h = all.hit(t, p, direction); h < first.value) first = {t, h};
        }
        const auto byTree = tree.nearest(p, [&](int t) { return all.squaredDistance(t, p); });
        CHECK(byTree.primitive == nearest.primitive);
        CHECK(byTree.value == nearest.value);
        const auto hitByTree = tree.firstHit(p, direction, [&](int t) { return all.hit(t, p, direction); });
        CHECK(hitByTree.primitive == first.primitive);
        CHECK(hitByTree.value == first.value);
        const Box query{p, p + randomPoint(random, 0, 1)};
        std::vector<int> found{-7};
        tree.overlapping(query, found);
        CHECK(found == overlappingByHand(all.boxes(), query));
    }
}

} // namespace

TEST_CASE("the tree finds what brute force finds: overlaps, the nearest triangle, the first hit of a ray")
{
    std::mt19937 random(1);
    for (int count : {1, 2, 4, 5, 9, 100, 1000}) {
        const Triangles all(random, count);
        const Bvh tree(all.boxes());
        CHECK(tree.size() == count);
        checkAgainstBruteForce(tree, all, random);
    }
}

TEST_CASE("a refitted tree finds what brute force finds after everything has moved")
{
    std::mt19937 random(2);
    Triangles all(random, 300);
    Bvh tree(all.boxes());
    for (auto& triangle : all.corners)
        for (Vec3& corner : triangle) corner = {2 * corner.y, corner.z - 1, corner.x + corner.y};
    tree.refit(all.boxes());
    checkAgainstBruteForce(tree, all, random);
    Box around;
    for (const Box& box : all.boxes()) around = merged(around, box);
    CHECK(tree.bounds() == around);
}

TEST_CASE("pairs of two trees are those that brute force finds, ascending")
{
    std::mt19937 random(3);
    for (auto [m, n] : {std::array{1, 1}, {7, 300}, {300, 7}, {200, 200}}) {
        const std::vector<Box> a = randomBoxes(random, m, 0.3), b = randomBoxes(random, n, 0.2);
        std::vector<std::array<int, 2>> expected, found{{-1, -1}};
        for (int i = 0; i < m; ++i)
            for (int k : overlappingByHand(b, a[i])) expected.push_back({i, k});
        overlappingPairs(Bvh(a), Bvh(b), found);
        CHECK(found == expected);
    }
}

TEST_CASE("ties go to the lowest index")
{
    const std::vector<Box> boxes(50, Box{{0, 0, 0}, {1, 1, 1}});
    const Bvh tree(boxes);
    CHECK(tree.nearest({2, 0, 0}, [](int) { return 1.0; }).primitive == 0);
    CHECK(tree.nearest({2, 0, 0}, [](int i) { return i < 20 ? 2.0 : 1.0; }).primitive == 20);
    CHECK(tree.firstHit({-1, 0.5, 0.5}, {1, 0, 0}, [](int i) { return i < 30 ? Box::kFar : 1.0; }).primitive == 30);
}

TEST_CASE("what lies beyond the given distance is not found, what lies at it is")
{
    const std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}};
    const Bvh tree(boxes);
    const auto distanceTo = [&](Vec3 p) { return [&, p](int i) { return squaredDistance(boxes[i], p); }; };
    CHECK(tree.nearest({3, 0, 0}, distanceTo({3, 0, 0}), 3.9).primitive == -1);
    CHECK(tree.nearest({3, 0, 0}, distanceTo({3, 0, 0}), 4.0).primitive == 0);
    CHECK(tree.firstHit(
                  {-2, 0.5, 0.5}, {1, 0, 0}, [](int) { return 2.0; }, 1.9)
              .primitive == -1);
    CHECK(tree.firstHit(
                  {-2, 0.5, 0.5}, {1, 0, 0}, [](int) { return 2.0; }, 2.0)
              .primitive == 0);
}

TEST_CASE("an empty tree finds nothing")
{
    const Bvh tree;
    std::vector<int> found{1};
    tree.overlapping({{-1, -1, -1}, {1, 1, 1}}, found);
    CHECK(found.empty());
    CHECK(tree.nearest({}, [](int) { return 0.0; }).primitive == -1);
    CHECK(tree.firstHit({}, {1, 0, 0}, [](int) { return 0.0; }).primitive == -1);
    std::vector<std::array<int, 2>> pairs{{0, 0}};
    overlappingPairs(tree, tree, pairs);
    CHECK(pairs.empty());
}

TEST_CASE("rays along the axes hit flat boxes, also from their border")
{
    const std::vector<Box> boxes{{{0, 0, 1}, {1, 1, 1}}};
    const Bvh tree(boxes);
    const auto always = [](int) { return 1.0; };
    CHECK(tree.firstHit({0.5, 0.5, 0}, {0, 0, 1}, always).primitive == 0);
    CHECK(tree.firstHit({0, 0, 0}, {0, 0, 1}, always).primitive == 0);
    CHECK(tree.firstHit({-1, 0.5, 1}, {1, 0, 0}, always).primitive == 0);
    CHECK(tree.firstHit({0.5, 0.5, 0}, {0, 0, -1}, always).primitive == -1);
    CHECK(tree.firstHit({2, 0.5, 0}, {0, 0, 1}, always).primitive == -1);
}

TEST_CASE("a primitive whose box became empty or NaN is not found, and hides no other")
{
    std::mt19937 random(5);
    std::vector<Box> boxes = randomBoxes(random, 40, 0.1);
    Bvh tree(boxes);
    boxes[3].low.x = std::numeric_limits<double>::quiet_NaN();
    boxes[9] = {};
    tree.refit(boxes);
    std::vector<int> found;
    tree.overlapping({{-Box::kFar, -Box::kFar, -Box::kFar}, {Box::kFar, Box::kFar, Box::kFar}}, found);
    CHECK(found.size() == 38);
    CHECK(std::ranges::count(found, 3) == 0);
    CHECK(std::ranges::count(found, 9) == 0);
    std::vector<int> asked;
    static_cast<void>(tree.nearest({}, [&](int i) { return asked.push_back(i), Box::kFar; }));
    CHECK(asked.size() == 38);
}

} // namespace bvh_test
