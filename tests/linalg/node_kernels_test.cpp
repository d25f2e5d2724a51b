#include "filasofia/linalg/node_kernels.h"

#include "filasofia/core/hash.h"

#include "linalg/random_matrix.h"

#include <bit>
#include <cstring>
#include <map>

using namespace filasofia;
using namespace filasofia::linalg;

// Tolerances are counts of roundings (WorstError): of n products added up one after the other, each may add one
// rounding of all that was summed so far, whatever the order.

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Calls test(blocks, range) for arrays of 1 to 40 blocks and ranges over all of them, over their middle, and empty.
template <class Test> void onManyRanges(const Test& test)
{
    for (int blocks : {1, 2, 3, 5, 16, 17, 40})
        for (const Blocks range : {Blocks{0, blocks}, Blocks{blocks / 3, blocks - blocks / 4},
                                   Blocks{blocks - 1, blocks}, Blocks{blocks / 2, blocks / 2}}) {
            INFO(blocks << " blocks, from " << range.begin << " to " << range.end);
            test(blocks, range);
        }
}

NodeArray randomBlocks(std::mt19937& random, int blocks) { return randomNodes(random, kBlock * blocks); }

bool inside(int node, Blocks range) { return node >= kBlock * range.begin && node < kBlock * range.end; }

bool sameBits(const float* a, const float* b, std::size_t floats) { return std::memcmp(a, b, 4 * floats) == 0; }

/// Whether nothing but the range differs from what was there before.
bool untouchedOutside(Blocks range, const NodeArray& before, const NodeArray& after)
{
    for (int node = 0; node < kBlock * before.blocks(); ++node)
        if (!inside(node, range) && !sameBits(before[node], after[node], 4)) return false;
    return true;
}

/// What a sum should be, and how large its terms are.
struct Sum {
    double value = 0.0, size = 0.0;
    void add(double term) { value += term, size += std::abs(term); }
};

/// a * b + c as an instruction set with or without fused multiply-add does it.
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

Sum product(const NodeArray& a, const NodeArray& b, Blocks range)
{
    Sum sum;
    for (int node = kBlock * range.begin; node < kBlock * range.end; ++node)
        for (int i = 0; i < 3; ++i) sum.add(static_cast<double>(a[node][i]) * b[node][i]);
    return sum;
}

/// Corners of elements around nodes: `most` or fewer for each, also none, in random places.
Gather randomGather(std::mt19937& random, int blocks, int elementBlocks, int most)
{
    Gather gather{.starts = {0}, .places = {}};
    for (int node = 0; node < kBlock * blocks; ++node) {
        for (int left = static_cast<int>(random() % (most + 1)); left > 0; --left)
            gather.places.push_back(4 * static_cast<int>(random() % (64u * elementBlocks)));
        gather.starts.push_back(static_cast<int>(gather.places.size()));
    }
    return gather;
}

/// Vectors that elements or quaternions lie in, aligned as the kernels need them.
std::span<const float> floats(const NodeArray& array)
{
    return {array.data(), 64 * static_cast<std::size_t>(array.blocks())};
}

std::vector<float> randomFloats(std::mt19937& random, std::size_t count)
{
    std::vector<float> numbers(count);
    for (float& each : numbers) each = randomFloat(random);
    return numbers;
}

/// Weights of 1 to 4 coarse nodes for every node. Behind the last coarse node lies a float that nobody may look at.
struct Coarse {
    Coarse(std::mt19937& random, int blocks, int nodes)
        : values(randomFloats(random, 3 * static_cast<std::size_t>(nodes))), from(static_cast<std::size_t>(blocks))
    {
        values.push_back(static_cast<float>(kNaN));
        for (InterpolationBlock& block : from)
            for (int i = 0; i < kBlock; ++i)
                for (int k = 0; k < 4; ++k) {
                    block.at[i][k] = 3 * static_cast<int>(random() % static_cast<unsigned>(nodes));
                    block.weights[i][k] = random() % 4 == 0 ? 0.0f : randomFloat(random);
                }
    }
    std::vector<float> values;
    std::vector<InterpolationBlock> from;
};

Restriction randomRestriction(std::mt19937& random, int nodes, int coarseNodes)
{
    Restriction restriction{.starts = {0}, .nodes = {}, .weights = {}};
    for (int c = 0; c < coarseNodes; ++c) {
        for (int left = static_cast<int>(random() % 30); left > 0; --left) {
            restriction.nodes.push_back(static_cast<int>(random() % static_cast<unsigned>(nodes)));
            restriction.weights.push_back(randomFloat(random));
        }
        restriction.starts.push_back(static_cast<int>(restriction.nodes.size()));
    }
    return restriction;
}

std::vector<SymmetricBlock> randomSymmetric(std::mt19937& random, int blocks)
{
    std::vector<SymmetricBlock> matrices(static_cast<std::size_t>(blocks));
    for (SymmetricBlock& block : matrices)
        for (auto& entry : block.m)
            for (float& each : entry) each = randomFloat(random);
    return matrices;
}

std::vector<PanelRow> randomPanels(std::mt19937& random, int panels, int rows)
{
    std::vector<PanelRow> matrix(static_cast<std::size_t>(panels) * rows);
    for (PanelRow& row : matrix)
        for (float& each : row.values) each = randomFloat(random);
    return matrix;
}

Mat3 absolute(Mat3 m)
{
    for (int k = 0; k < 9; ++k) m[k / 3][k % 3] = std::abs(m[k / 3][k % 3]);
    return m;
}
Vec3 absolute(Vec3 v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

void compare(WorstError& worst, const float* value, Vec3 exact, Vec3 size)
{
    for (int i = 0; i < 3; ++i) worst.compare(value[i], exact[i], size[i]);
    worst.compare(value[3], 0.0, 0.0); // the fourth float stays zero: sums run over it
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

TEST_CASE("an instruction set fuses multiply and add where its name says so, and only there")
{
    onEveryTarget([](const std::string& target) {
        // (1 + e)^2 - (1 + 2 e) is e^2, but zero where the product is rounded first.
        NodeArray z(1), p(1);
        z[5][1] = -(1.0f + 0x1p-11f);
        p[5][1] = 1.0f + 0x1p-12f;
        turn(z, 1.0f + 0x1p-12f, p, {0, 1});
        CHECK(p[5][1] == (isFused(target) ? 0x1p-24f : 0.0f));
    });
}

TEST_CASE("dot, turn and descend do what they say to the last bit, and nothing outside their blocks")
{
    onEveryTarget([](const std::string& target) {
        const bool fused = isFused(target);
        std::mt19937 random(1);
        onManyRanges([&](int blocks, Blocks range) {
            const NodeArray a = randomBlocks(random, blocks), b = randomBlocks(random, blocks);
            CHECK(dot(a, b, range) == laneSum(fused, a, b, range));

            NodeArray p = randomBlocks(random, blocks), x = a, r = b;
            const NodeArray before = p, q = randomBlocks(random, blocks);
            turn(a, 0.7f, p, range);
            const double square = descend(0.3f, p, q, x, r, range);
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
            CHECK(worst.roundings() <= 4 * blocks + 1); // four rows of a block after the other, products and sums
        });
    });
}

TEST_CASE("a residual is turned into the rest frame and smoothed there")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(3);
        WorstError turned, smoothed;
        onManyRanges([&](int blocks, Blocks range) {
            const std::vector<RotationBlock> rotations = randomRotations(random, blocks);
            const std::vector<SymmetricBlock> inverseDiagonal = randomSymmetric(random, blocks);
            const NodeArray r = randomBlocks(random, blocks), before = randomBlocks(random, blocks);
            NodeArray s = before, w = before;
            warpAndSmooth(rotations, inverseDiagonal, r, s, w, range);
            CHECK(untouchedOutside(range, before, s));
            CHECK(untouchedOutside(range, before, w));
            for (int node = kBlock * range.begin; node < kBlock * range.end; ++node) {
                const auto& m = inverseDiagonal[static_cast<std::size_t>(node / kBlock)].m;
                const auto entry = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
                const Mat3 d{
                    {{entry(0), entry(1), entry(2)}, {entry(1), entry(3), entry(4)}, {entry(2), entry(4), entry(5)}}};
                const Mat3 back = transpose(rotationOf(rotations, node));
                const Vec3 v = vectorOf(r[node]), size = absolute(back) * absolute(v);
                compare(turned, s[node], back * v, size);
                compare(smoothed, w[node], d * (back * v), absolute(d) * size);
            }
        });
        CHECK(turned.roundings() <= 3); // two sums of products
        CHECK(smoothed.roundings() <= 6);
    });
}

TEST_CASE("what the coarse nodes say is added, turned back and multiplied by the residual; without them only turned")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(4);
        WorstError vectors;
        onManyRanges([&](int blocks, Blocks range) {
            for (const int coarseNodes : {0, 1, 9}) {
                const std::vector<RotationBlock> rotations = randomRotations(random, blocks);
                const Coarse coarse(random, coarseNodes == 0 ? 0 : blocks, std::max(coarseNodes, 1));
                const NodeArray w = randomBlocks(random, blocks), r = randomBlocks(random, blocks);
                const NodeArray before = randomBlocks(random, blocks);
                NodeArray z = before;
                const double found = prolongAndUnwarp(rotations, coarse.from, coarse.values, w, r, z, range);
                CHECK(untouchedOutside(range, before, z));
                const Sum exact = product(r, z, range); // of z as it is: how it came about is looked at below
                WorstError sum;
                sum.compare(found, exact.value, exact.size);
                CHECK(sum.roundings() <= blocks + 3); // one node of a lane after the other, each from three products
                for (int node = kBlock * range.begin; node < kBlock * range.end; ++node) {
                    Vec3 rest = vectorOf(w[node]), size = absolute(rest);
                    for (int k = 0; k < 4 && coarseNodes > 0; ++k) {
                        const InterpolationBlock& from = coarse.from[static_cast<std::size_t>(node / kBlock)];
                        const double weight = from.weights[node % kBlock][k];
                        const Vec3 value = vectorOf(coarse.values.data() + from.at[node % kBlock][k]);
                        rest += weight * value;
                        size += absolute(weight * value);
                    }
                    const Mat3 turn = rotationOf(rotations, node);
                    compare(vectors, z[node], turn * rest, absolute(turn) * size);
                }
            }
        });
        CHECK(vectors.roundings() <= 11); // up to eight for the coarse nodes, three for the rotation
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
                    for (int k = restriction.starts[c]; k < restriction.starts[c + 1]; ++k)
                        sum.add(static_cast<double>(restriction.weights[k]) * s[restriction.nodes[k]][i]);
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
            const double py = gatherAndAdd(gather, floats(corners), 1.7f, masses, extra, p, y, range);
            const double ff = gatherForces(gather, floats(corners), 1.7f, masses, extra, p, f, range);
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
                for (int k = gather.starts[node]; k < gather.starts[node + 1]; ++k) {
                    const Vec3 corner = vectorOf(corners.data() + gather.places[k]);
                    sum += corner;
                    size += absolute(corner);
                }
                compare(vectors, y[node], diagonal * v + sum, size);
                compare(vectors, f[node], old + sum - diagonal * v, size + absolute(old));
            }
        });
        CHECK(vectors.roundings() <= 15); // half of twenty corners one after the other, and five more
    });
}

TEST_CASE(
    "a node turns like the elements around it: the sign of a quaternion does not matter, and none is the identity")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(8);
        WorstError worst;
        onManyRanges([&](int blocks, Blocks range) {
            NodeArray quaternions(3); // of three blocks of elements, all near one rotation, every other one with -q
            Gather gather = randomGather(random, blocks, 3, 20);
            const Quat common = randomQuat(random);
            for (int at = 0; at < 48; ++at) {
                const Quat near = normalized(common * axisAngle(vectorOf(randomNodes(random, 1)[0]), 0.2));
                const double sign = at % 2 == 0 ? 1.0 : -1.0;
                const double entries[4] = {sign * near.x, sign * near.y, sign * near.z, sign * near.w};
                for (int i = 0; i < 4; ++i) quaternions[at][i] = static_cast<float>(entries[i]);
            }
            // A node sees one sign only, or as many of one as of the other: two corners, then, for one of two.
            const auto elementAt = [&](int k) { return gather.places[k] / 256 * 16 + gather.places[k] % 64 / 4; };
            for (int node = 0; node < kBlock * blocks; ++node)
                for (int k = gather.starts[node]; k < gather.starts[node + 1]; ++k)
                    if (elementAt(k) % 2 != (node % 2 == 0 ? 0 : (k - gather.starts[node]) % 2)) gather.places[k] ^= 4;

            std::vector<RotationBlock> rotations = randomRotations(random, blocks);
            const std::vector<RotationBlock> before = rotations;
            averageRotations(gather, floats(quaternions), rotations, range);
            for (int node = 0; node < kBlock * blocks; ++node) {
                Quat sum{0, 0, 0, 0};
                for (int k = gather.starts[node]; k < gather.starts[node + 1]; ++k) {
                    const float* q = quaternions[elementAt(k)];
                    const double side = dot({q[3], q[0], q[1], q[2]}, common) < 0.0 ? -1.0 : 1.0;
                    sum = {sum.w + side * q[3], sum.x + side * q[0], sum.y + side * q[1], sum.z + side * q[2]};
                }
                const bool written = inside(node, range), none = gather.starts[node] == gather.starts[node + 1];
                const Mat3 exact = written ? toMat3(normalized(sum)) : rotationOf(before, node);
                const Mat3 found = rotationOf(rotations, node);
                for (int k = 0; k < 9; ++k)
                    worst.compare(found[k / 3][k % 3], exact[k / 3][k % 3], written && !none ? 1.0 : 0.0);
            }
        });
        CHECK(worst.roundings() <= 25); // of the largest entry: up to ten sums, squared, and the products
    });
}

TEST_CASE("instruction sets with fused multiply-add give the same bits; those without are held to the tolerances above")
{
    checkSameBitsWhereFused([] {
        std::mt19937 random(9);
        std::map<std::string, std::uint64_t> bits;
        const auto add = [&](const char* name, std::span<const float> all, double sum = 0.0) {
            Hasher hash;
            for (float each : all) hash.add(std::uint64_t{std::bit_cast<std::uint32_t>(each)});
            hash.add(sum);
            bits[name] = hash.value();
        };
        constexpr int kBlocks = 37, kCoarse = 21, kRows = 64;
        const Blocks range{3, 35};
        NodeArray p = randomBlocks(random, kBlocks), q = p, x = p, r = randomBlocks(random, kBlocks), z = r;
        add("dot", {}, dot(p, r, range));
        turn(z, 0.3f, p, range);
        add("turn", floats(p));
        const double square = descend(0.2f, p, q, x, r, range);
        add("descend x", floats(x));
        add("descend r", floats(r), square);

        std::vector<RotationBlock> rotations = randomRotations(random, kBlocks);
        warpAndSmooth(rotations, randomSymmetric(random, kBlocks), r, x, q, range);
        add("warp", floats(x));
        add("smooth", floats(q));
        const Coarse coarse(random, kBlocks, kCoarse);
        const double rz = prolongAndUnwarp(rotations, coarse.from, coarse.values, q, r, z, range);
        add("prolong", floats(z), rz);
        const double rw = prolongAndUnwarp(rotations, {}, {}, q, r, z, range);
        add("unwarp", floats(z), rw);
        std::vector<float> packed(3 * kCoarse), y(16 * kCoarse);
        restrictTo(randomRestriction(random, kBlock * kBlocks, kCoarse), x, packed, 0, kCoarse);
        add("restrict", packed);
        multiplyPanels(randomPanels(random, kCoarse, kRows), randomFloats(random, kRows), y, 0, kCoarse);
        add("panels", y);

        const NodeArray corners = randomBlocks(random, 4 * 5);
        const Gather gather = randomGather(random, kBlocks, 5, 20);
        const std::vector<float> masses = randomFloats(random, kBlock * kBlocks);
        const double py = gatherAndAdd(gather, floats(corners), 1.7f, masses, masses, p, q, range);
        add("gather product", floats(q), py);
        const double ff = gatherForces(gather, floats(corners), 1.7f, masses, masses, p, q, range);
        add("gather forces", floats(q), ff);
        NodeArray quaternions(5); // at random: sums that cancel, and that do not
        for (int at = 0; at < 5 * kBlock; ++at) {
            const Quat each = randomQuat(random);
            const double entries[4] = {each.x, each.y, each.z, each.w};
            for (int i = 0; i < 4; ++i) quaternions[at][i] = static_cast<float>(entries[i]);
        }
        averageRotations(gather, floats(quaternions), rotations, range);
        add("rotations", {&rotations[0].m[0][0], rotations.size() * sizeof(RotationBlock) / sizeof(float)});
        return bits;
    });
}
