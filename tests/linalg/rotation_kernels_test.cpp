#include "filasofia/linalg/rotation_kernels.h"

#include "linalg/node_checks.h"

namespace rotation_kernels_test {

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Weights of 1 to 4 coarse nodes for every node. Behind the last coarse node lies a NaN that must not be used.
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

std::vector<SymmetricBlock> randomSymmetric(std::mt19937& random, int blocks)
{
    std::vector<SymmetricBlock> matrices(static_cast<std::size_t>(blocks));
    for (SymmetricBlock& block : matrices)
        for (auto& entry : block.m)
            for (float& each : entry) each = randomFloat(random);
    return matrices;
}

} // namespace

TEST_CASE("a residual is rotated into the rest frame and smoothed there")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(3);
        WorstError rotated, smoothed;
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
                compare(rotated, s[node], back * v, size);
                compare(smoothed, w[node], d * (back * v), absolute(d) * size);
            }
        });
        CHECK(rotated.roundings() <= 3); // two sums of products
        CHECK(smoothed.roundings() <= 6);
    });
}

TEST_CASE(
    "the coarse correction is added, the sum rotated and multiplied by the residual, and without coarse nodes it is "
    "only rotated")
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
                const double found = prolongAndUnwarp(rotations, {coarse.from, coarse.values}, w, r, z, range);
                CHECK(untouchedOutside(range, before, z));
                const Sum exact = product(r, z, range); // with z as it is; its own error is checked below
                WorstError sum;
                sum.compare(found, exact.value, exact.size);
                CHECK(sum.roundings() <= blocks + 3); // one node per lane after another, each of three products
                for (int node = kBlock * range.begin; node < kBlock * range.end; ++node) {
                    Vec3 rest = vectorOf(w[node]), size = absolute(rest);
                    for (int k = 0; k < 4 && coarseNodes > 0; ++k) {
                        const InterpolationBlock& from = coarse.from[static_cast<std::size_t>(node / kBlock)];
                        const double weight = from.weights[node % kBlock][k];
                        const Vec3 value = vectorOf(coarse.values.data() + from.at[node % kBlock][k]);
                        rest += weight * value;
                        size += absolute(weight * value);
                    }
                    const Mat3 rotation = rotationOf(rotations, node);
                    compare(vectors, z[node], rotation * rest, absolute(rotation) * size);
                }
            }
        });
        CHECK(vectors.roundings() <= 11); // up to eight for the coarse nodes, three for the rotation
    });
}

TEST_CASE("a node rotates as its elements do, whatever the signs of their quaternions, and without elements not at all")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(8);
        WorstError worst;
        onManyRanges([&](int blocks, Blocks range) {
            NodeArray quaternions(3); // three blocks of elements, all near one rotation, every other one as -q
            Gather gather = randomGather(random, blocks, 3, 20);
            const Quat common = randomQuat(random);
            for (int at = 0; at < 48; ++at) {
                const Quat near = normalized(common * axisAngle(vectorOf(randomNodes(random, 1)[0]), 0.2));
                const double sign = at % 2 == 0 ? 1.0 : -1.0;
                const double entries[4] = {sign * near.x, sign * near.y, sign * near.z, sign * near.w};
                for (int i = 0; i < 4; ++i) quaternions[at][i] = static_cast<float>(entries[i]);
            }
            // Even nodes see one sign only; odd nodes see both in turn, so that their plain sums nearly cancel.
            const auto elementAt = [&](int k) { return gather.values[k] / 256 * 16 + gather.values[k] % 64 / 4; };
            for (int node = 0; node < kBlock * blocks; ++node)
                for (int k = gather.ranges[node].begin; k < gather.ranges[node].end; ++k)
                    if (elementAt(k) % 2 != (node % 2 == 0 ? 0 : (k - gather.ranges[node].begin) % 2))
                        gather.values[k] ^= 4;

            std::vector<RotationBlock> rotations = randomRotations(random, blocks);
            const std::vector<RotationBlock> before = rotations;
            averageRotations(gather, floats(quaternions), rotations, range);
            for (int node = 0; node < kBlock * blocks; ++node) {
                Quat sum{0, 0, 0, 0};
                for (int k = gather.ranges[node].begin; k < gather.ranges[node].end; ++k) {
                    const float* q = quaternions[elementAt(k)];
                    const double side = dot({q[3], q[0], q[1], q[2]}, common) < 0.0 ? -1.0 : 1.0;
                    sum = {sum.w + side * q[3], sum.x + side * q[0], sum.y + side * q[1], sum.z + side * q[2]};
                }
                const bool written = inside(node, range), none = gather.ranges[node].begin == gather.ranges[node].end;
                const Mat3 exact = written ? toMat3(normalized(sum)) : rotationOf(before, node);
                const Mat3 found = rotationOf(rotations, node);
                for (int k = 0; k < 9; ++k)
                    worst.compare(found[k / 3][k % 3], exact[k / 3][k % 3], written && !none ? 1.0 : 0.0);
            }
        });
        CHECK(worst.roundings() <= 25); // relative to the largest entry: up to ten sums, squared, and the products
    });
}

TEST_CASE("rotations and rotated vectors have the same bits on instruction sets with fused multiply-add")
{
    checkSameBitsWhereFused([] {
        std::mt19937 random(9);
        NamedBits found;
        constexpr int kBlocks = 37, kCoarse = 21;
        const Blocks range{3, 35};
        const NodeArray r = randomBlocks(random, kBlocks);
        NodeArray x = randomBlocks(random, kBlocks), q = x, z = x;
        std::vector<RotationBlock> rotations = randomRotations(random, kBlocks);
        warpAndSmooth(rotations, randomSymmetric(random, kBlocks), r, x, q, range);
        found.add("warp", floats(x));
        found.add("smooth", floats(q));
        const Coarse coarse(random, kBlocks, kCoarse);
        const double rz = prolongAndUnwarp(rotations, {coarse.from, coarse.values}, q, r, z, range);
        found.add("prolong", floats(z), rz);
        const double rw = prolongAndUnwarp(rotations, {}, q, r, z, range);
        found.add("unwarp", floats(z), rw);
        const Gather gather = randomGather(random, kBlocks, 5, 20);
        NodeArray quaternions(5); // random ones: some sums cancel
        for (int at = 0; at < 5 * kBlock; ++at) {
            const Quat each = randomQuat(random);
            const double entries[4] = {each.x, each.y, each.z, each.w};
            for (int i = 0; i < 4; ++i) quaternions[at][i] = static_cast<float>(entries[i]);
        }
        averageRotations(gather, floats(quaternions), rotations, range);
        found.add("rotations", {&rotations[0].m[0][0], rotations.size() * sizeof(RotationBlock) / sizeof(float)});
        return found.bits;
    });
}

} // namespace rotation_kernels_test
