#include "filasofia/linalg/node_kernels.h"

#include "linalg/node_checks.h"

namespace node_kernels_test {

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

/// a * b + c as an instruction set computes it that has, or does not have, fused multiply-add.
float multiplyAdd(bool fused, float a, float b, float c) { return fused ? std::fma(a, b, c) : a * b + c; }

/// The sum of products that the header promises: lane by lane, then over the sixteen lanes in double.
double laneSum(bool fused, const NodeArray& a, const NodeArray& b, Blocks range)
{
    double sum = 0.0;
    for (int lane = 0; lane < kBlock; ++lane) {
        float one = 0.0f;
        for (int i = 64 * range.begin + lane; i < 64 * range.end; i += kBlock)
            one = multiplyAdd(fused, a.data()[i], b.data()[i], one);
        sum += static_cast<double>(one);
    }
    return sum;
}

Restriction randomRestriction(std::mt19937& random, int nodes, int coarseNodes)
{
    std::vector<std::vector<RestrictionEntry>> entries(static_cast<std::size_t>(coarseNodes));
    for (std::vector<RestrictionEntry>& list : entries)
        for (int left = static_cast<int>(random() % 30); left > 0; --left)
            list.push_back({static_cast<int>(random() % static_cast<unsigned>(nodes)), randomFloat(random)});
    return Restriction(entries);
}

std::vector<PanelRow> randomPanels(std::mt19937& random, int panels, int rows)
{
    std::vector<PanelRow> matrix(static_cast<std::size_t>(panels) * rows);
    for (PanelRow& row : matrix)
        for (float& each : row.values) each = randomFloat(random);
    return matrix;
}

} // namespace

TEST_CASE("the best instruction set comes first, is in use, and comes back after another one")
{
    const std::vector<std::string> targets = simdTargets();
    REQUIRE(!targets.empty());
    CHECK(simdTarget() == targets.front());
    useSimdTarget(targets.back());
    CHECK(simdTarget() == targets.back());
    useSimdTarget({});
    CHECK(simdTargets() == targets);
}

TEST_CASE("an instruction set fuses multiply and add if its name says so, and only then")
{
    onEveryTarget([](const std::string& target) {
        // (1 + e)^2 - (1 + 2 e) is e^2, but zero if the product is rounded first.
        NodeArray z(1), p(1);
        z[5][1] = -(1.0f + 0x1p-11f);
        p[5][1] = 1.0f + 0x1p-12f;
        updateDirection(z, 1.0f + 0x1p-12f, p, {0, 1});
        CHECK(p[5][1] == (isFused(target) ? 0x1p-24f : 0.0f));
    });
}

TEST_CASE("dot, updateDirection and stepAlong have the right bits, and write nothing outside their blocks")
{
    onEveryTarget([](const std::string& target) {
        const bool fused = isFused(target);
        std::mt19937 random(1);
        onManyRanges([&](int blocks, Blocks range) {
            const NodeArray a = randomBlocks(random, blocks), b = randomBlocks(random, blocks);
            CHECK(dot(a, b, range) == laneSum(fused, a, b, range));

            NodeArray p = randomBlocks(random, blocks), x = a, r = b;
            const NodeArray before = p, q = randomBlocks(random, blocks);
            updateDirection(a, 0.7f, p, range);
            const double square = stepAlong(0.3f, p, q, x, r, range);
            bool same = true;
            for (int i = 64 * range.begin; i < 64 * range.end; ++i)
                same = same && p.data()[i] == multiplyAdd(fused, 0.7f, before.data()[i], a.data()[i]) &&
                       x.data()[i] == multiplyAdd(fused, 0.3f, p.data()[i], a.data()[i]) &&
                       r.data()[i] == multiplyAdd(fused, -0.3f, q.data()[i], b.data()[i]);
            CHECK(same);
            CHECK(square == laneSum(fused, r, r, range));
            CHECK(untouchedOutside(range, before, p));
            CHECK(untouchedOutside(range, a, x));
            CHECK(untouchedOutside(range, b, r));
        });
    });
}

TEST_CASE("sums of products are right to the rounding of each lane's own sum")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(2);
        onManyRanges([&](int blocks, Blocks range) {
            const NodeArray a = randomBlocks(random, blocks), b = randomBlocks(random, blocks);
            const Sum exact = product(a, b, range);
            WorstError worst;
            worst.compare(dot(a, b, range), exact.value, exact.size);
            CHECK(worst.roundings() <= 4 * blocks + 1); // four rows per block, one after another, products and sums
        });
    });
}

TEST_CASE("coarse nodes sum up their nodes, many, one or none, in any range")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(5);
        onManyRanges([&](int coarseNodes, Blocks range) {
            const NodeArray s = randomBlocks(random, 4);
            const Restriction restriction = randomRestriction(random, 4 * kBlock, coarseNodes);
            const std::vector<float> before = randomFloats(random, 3 * static_cast<std::size_t>(coarseNodes));
            std::vector<float> coarse = before;
            restrictTo(restriction, s, coarse, range.begin, range.end);
            WorstError worst;
            for (int c = 0; c < coarseNodes; ++c)
                for (int i = 0; i < 3; ++i) {
                    Sum sum;
                    for (const auto* from = restriction.begin(c); from != restriction.end(c); ++from)
                        sum.add(static_cast<double>(from->weight) * s[from->node][i]);
                    const bool written = c >= range.begin && c < range.end;
                    worst.compare(coarse[3 * c + i], written ? sum.value : before[3 * c + i], written ? sum.size : 0.0);
                }
            CHECK(worst.roundings() <= 31);
        });
    });
}

TEST_CASE("panels of a dense matrix give the products of their columns, and no others")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(6);
        for (const int rows : {4, 12, 60})
            onManyRanges([&](int panels, Blocks range) {
                const std::vector<PanelRow> matrix = randomPanels(random, panels, rows);
                const std::vector<float> x = randomFloats(random, static_cast<std::size_t>(rows));
                const std::vector<float> before = randomFloats(random, 16 * static_cast<std::size_t>(panels));
                std::vector<float> y = before;
                multiplyPanels(matrix, x, y, range.begin, range.end);
                WorstError worst;
                for (int column = 0; column < kBlock * panels; ++column) {
                    Sum sum;
                    for (int i = 0; i < rows; ++i)
                        sum.add(
                            static_cast<double>(
                                matrix[static_cast<std::size_t>(column / kBlock * rows + i)].values[column % kBlock]) *
                            x[i]);
                    const bool written = inside(column, range);
                    worst.compare(y[column], written ? sum.value : before[column], written ? sum.size : 0.0);
                }
                CHECK(worst.roundings() <= rows / 4 + 3);
            });
    });
}

TEST_CASE("nodes gather their corners, many, one or none, with their own masses and springs")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(7);
        WorstError vectors;
        onManyRanges([&](int blocks, Blocks range) {
            const NodeArray corners = randomBlocks(random, 4 * 5);
            const Gather gather = randomGather(random, blocks, 5, 20);
            const std::vector<float> masses = randomFloats(random, 16 * static_cast<std::size_t>(blocks));
            const std::vector<float> extra = randomFloats(random, masses.size());
            const NodeArray p = randomBlocks(random, blocks), before = randomBlocks(random, blocks);
            NodeArray y = before, f = before;
            const double py = gatherAndAdd({gather, floats(corners), 1.7f, masses, extra}, p, y, range);
            const double ff = gatherForces({gather, floats(corners), 1.7f, masses, extra}, p, f, range);
            CHECK(untouchedOutside(range, before, y));
            CHECK(untouchedOutside(range, before, f));
            WorstError sums;
            const Sum exactY = product(p, y, range), exactF = product(f, f, range);
            sums.compare(py, exactY.value, exactY.size);
            sums.compare(ff, exactF.value, exactF.size);
            CHECK(sums.roundings() <= 4 * blocks + 1);
            for (int node = kBlock * range.begin; node < kBlock * range.end; ++node) {
                const double diagonal = static_cast<double>(1.7f) * masses[node] + extra[node];
                const double absoluteDiagonal =
                    std::abs(static_cast<double>(1.7f) * masses[node]) + std::abs(extra[node]);
                const Vec3 v = vectorOf(p[node]), old = vectorOf(before[node]);
                Vec3 sum, size = absoluteDiagonal * absolute(v);
                for (int k = gather.ranges[node].begin; k < gather.ranges[node].end; ++k) {
                    const Vec3 corner = vectorOf(corners.data() + gather.values[k]);
                    sum += corner;
                    size += absolute(corner);
                }
                compare(vectors, y[node], diagonal * v + sum, size);
                compare(vectors, f[node], old + sum - diagonal * v, size + absolute(old));
            }
        });
        CHECK(vectors.roundings() <= 15); // half of twenty corners, one after another, and five more
    });
}

TEST_CASE("instruction sets with fused multiply-add give the same bits, those without are held to the tolerances above")
{
    checkSameBitsWhereFused([] {
        std::mt19937 random(9);
        NamedBits found;
        constexpr int kBlocks = 37, kCoarse = 21, kRows = 64;
        const Blocks range{3, 35};
        NodeArray p = randomBlocks(random, kBlocks), q = p, x = p, r = randomBlocks(random, kBlocks);
        found.add("dot", {}, dot(p, r, range));
        updateDirection(r, 0.3f, p, range);
        found.add("updateDirection", floats(p));
        const double square = stepAlong(0.2f, p, q, x, r, range);
        found.add("stepAlong x", floats(x));
        found.add("stepAlong r", floats(r), square);

        std::vector<float> packed(3 * kCoarse), y(16 * kCoarse);
        restrictTo(randomRestriction(random, kBlock * kBlocks, kCoarse), x, packed, 0, kCoarse);
        found.add("restrict", packed);
        multiplyPanels(randomPanels(random, kCoarse, kRows), randomFloats(random, kRows), y, 0, kCoarse);
        found.add("panels", y);
        std::vector<float> many(7 * y.size());
        multiplyPanels(randomPanels(random, kCoarse, kRows), randomFloats(random, 7 * kRows), many,
                       {.count = 7, .rows = kRows, .stride = kRows, .resultStride = static_cast<int>(y.size())},
                       kCoarse);
        found.add("panels, many vectors", many);

        const NodeArray corners = randomBlocks(random, 4 * 5);
        const Gather gather = randomGather(random, kBlocks, 5, 20);
        const std::vector<float> masses = randomFloats(random, kBlock * kBlocks);
        const double py = gatherAndAdd({gather, floats(corners), 1.7f, masses, masses}, p, q, range);
        found.add("gather product", floats(q), py);
        const double ff = gatherForces({gather, floats(corners), 1.7f, masses, masses}, p, q, range);
        found.add("gather forces", floats(q), ff);
        return found.bits;
    });
}

TEST_CASE("a dense matrix times many vectors is its product with each")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(7);
        constexpr int kRows = 60, kStride = 61, kPanels = 3, kEntries = kPanels * kBlock + 4;
        const std::vector<PanelRow> matrix = randomPanels(random, kPanels, kRows);
        for (const int count : {1, 5, 6, 13}) {
            const std::size_t vectors = static_cast<std::size_t>(count);
            const std::vector<float> x = randomFloats(random, vectors * kStride);
            std::vector<float> all(vectors * kEntries), one(kEntries);
            multiplyPanels(matrix, x, all, {.count = count, .rows = kRows, .stride = kStride, .resultStride = kEntries},
                           kPanels);
            for (std::size_t v = 0; v < vectors; ++v) {
                multiplyPanels(matrix, std::span(x).subspan(v * kStride, kRows), one, 0, kPanels);
                for (std::size_t k = 0; k < kPanels * kBlock; ++k)
                    CHECK(std::abs(all[v * kEntries + k] - one[k]) <= 1e-5f * kRows);
            }
        }
    });
}

} // namespace node_kernels_test
