#include "filasofia/engine/elastic/shell_blocks.h"

#include "filasofia/engine/elastic/bending.h"
#include "filasofia/engine/elastic/membrane.h"

#include "engine/elastic/element_blocks.h"
#include "engine/sheets.h"

namespace shell_blocks_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Triangles with six nodes of their own each, at rest and in a random state: three for stretching, all for bending.
struct Triangles {
    Triangles(std::mt19937& random, int many)
        : count(many), blocks(linalg::blocksFor(many)), x(6 * blocks), v(linalg::randomNodes(random, 96 * blocks)),
          p(linalg::randomNodes(random, 96 * blocks)), membraneBlocks(static_cast<std::size_t>(blocks)),
          membraneTangents(membraneBlocks.size()), bendingBlocks(membraneBlocks.size()),
          bendingTangents(membraneBlocks.size()), stretching(3 * blocks), stretched(3 * blocks), bending(6 * blocks),
          bent(6 * blocks), quaternions(blocks)
    {
        for (int lane = 0; lane < kBlock * blocks; ++lane) {
            if (lane < count) add(random, lane);
            write(std::min(lane, count - 1), lane, lane < count);
        }
    }

    void add(std::mt19937& random, int t)
    {
        BendingCorners at{Vec3{0, 0, 0},   {1, 0, 0},         {0.3, 0.8, 0},
                          {1.1, 0.9, 0.3}, {-0.7, 0.6, -0.2}, {0.4, -0.9, 0.1}};
        for (Vec3& each : at) each = inFloat(each + randomVec3(random, 0.15));
        MembraneElement membrane = membraneOn({0, 1, 2}, {at[0], at[1], at[2]});
        for (double& each : membrane.metric) each = inFloat(each);
        membrane.area = 1.0;
        membrane.shear = inFloat(0.5 + std::abs(randomVec3(random, 1.0).x));
        membrane.poissonRatio = t % 3 == 0 ? 0.0 : 0.45;
        membranes.push_back(membrane);
        BendingElement bend = bendingOn({0, 1, 2, 3, 4, 5}, {true, t % 4 != 0, true}, at, 0.3);
        bend.rigidity = 1.0;
        bends.push_back(bend);
        rests.push_back(at);
        const double size = t % 5 == 0 ? 0.0 : 0.2; // some are at rest, only turned
        const Quat turn = randomRotation(random);
        for (std::size_t i = 0; i < 6; ++i)
            store(rotate(turn, at[i]) + randomVec3(random, size), x[6 * t + static_cast<int>(i)]);
    }

    void write(int t, int lane, bool real)
    {
        const auto b = static_cast<std::size_t>(lane / kBlock), e = static_cast<std::size_t>(t);
        const int l = lane % kBlock;
        MembraneBlock& m = membraneBlocks[b];
        for (int i = 0; i < 3; ++i) m.nodes[i][l] = membraneTangents[b].nodes[i][l] = 4 * (6 * t + i);
        const auto& metric = membranes[e].metric;
        for (int k = 0; k < 3; ++k) m.metric[k][l] = static_cast<float>(metric[static_cast<std::size_t>(k)]);
        m.det[l] = static_cast<float>(metric[0] * metric[2] - metric[1] * metric[1]);
        m.weight[l] = real ? static_cast<float>(membranes[e].shear) : 0.0f;
        m.q[l] = static_cast<float>(1.0 - 2.0 * membranes[e].poissonRatio);
        const Vec3 first = normalized(rests[e][1] - rests[e][0]);
        const Vec3 normal = normalized(cross(rests[e][1] - rests[e][0], rests[e][2] - rests[e][0]));
        const Vec3 second = cross(normal, first);
        for (int k = 0; k < 3; ++k) {
            m.frame[k][l] = static_cast<float>(first[k]);
            m.frame[3 + k][l] = static_cast<float>(second[k]);
        }
        BendingBlock& n = bendingBlocks[b];
        for (int i = 0; i < 6; ++i) n.nodes[i][l] = bendingTangents[b].nodes[i][l] = 4 * (6 * t + i);
        for (int k = 0; k < 3; ++k)
            n.restAngles[k][l] = static_cast<float>(bends[e].restAngles[static_cast<std::size_t>(k)]);
        for (int k = 0; k < 6; ++k)
            n.stiffness[k][l] = real ? static_cast<float>(bends[e].shape[static_cast<std::size_t>(k)]) : 0.0f;
        n.leastArea[l] = static_cast<float>(bends[e].leastArea);
    }

    void run(int begin, int end)
    {
        const BlockInput input{x, v, kWeights};
        updateMembranes(membraneBlocks, input, {begin, end},
                        {membraneTangents, Elements::floats(stretching), Elements::floats(quaternions)});
        updateBends(bendingBlocks, input, {begin, end}, {bendingTangents, Elements::floats(bending)});
        multiplyMembranes(membraneTangents, p, Elements::floats(stretched), {begin, end});
        multiplyBends(bendingTangents, p, Elements::floats(bent), {begin, end});
    }

    /// The vector that a triangle wrote for a corner, of so many.
    static Vec3 corner(const NodeArray& array, int lane, int i, int corners)
    {
        return vectorOf(array.data() + lane / kBlock * 64 * corners + 64 * i + linalg::laneOffset(lane % kBlock));
    }
    [[nodiscard]] BendingCorners at(const NodeArray& array, int t) const
    {
        BendingCorners out;
        for (int i = 0; i < 6; ++i) out[static_cast<std::size_t>(i)] = vectorOf(array[6 * t + i]);
        return out;
    }

    int count, blocks;
    NodeArray x, v, p;
    std::vector<MembraneElement> membranes;
    std::vector<BendingElement> bends;
    std::vector<BendingCorners> rests;
    std::vector<MembraneBlock> membraneBlocks;
    std::vector<MembraneTangentBlock> membraneTangents;
    std::vector<BendingBlock> bendingBlocks;
    std::vector<BendingTangentBlock> bendingTangents;
    NodeArray stretching, stretched, bending, bent, quaternions;
};

/// The sum of the entries of a tangent's blocks, which bounds the terms of a product with vectors of length 1.
template <class Tangent> double sizeOf(const Tangent& tangent, int nodes)
{
    double size = 0.0;
    for (int i = 0; i < nodes; ++i)
        for (int j = 0; j < nodes; ++j) size += frobeniusNorm(stiffnessBlock(tangent, i, j));
    return size;
}

TriangleCorners firstThree(const BendingCorners& all) { return {all[0], all[1], all[2]}; }

} // namespace

TEST_CASE("blocks of triangles match the double-precision membrane, at rest, stretched and crushed")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(20);
        Triangles all(random, 16 * 6 - 3);
        all.run(0, all.blocks);
        WorstError forces, products;
        for (int lane = 0; lane < kBlock * all.blocks; ++lane) {
            TriangleCorners force{}, product{};
            double size = 0.0;
            if (lane < all.count) {
                const MembraneElement& e = all.membranes[static_cast<std::size_t>(lane)];
                const TriangleCorners x = firstThree(all.at(all.x, lane));
                const MembraneTangent tangent = membraneTangent(e, x, kWeights.turning);
                // Growth is a difference of two terms, which are large if the triangle is crushed.
                const auto [s, r] = membraneStretches(e, x);
                const double q = 1.0 - 2.0 * e.poissonRatio, over = (1.0 + q) / (q + s * s * r * r);
                const double metric = e.metric[0] + e.metric[2];
                size = 4.0 * kWeights.stiffness * e.shear * metric * (1.0 + (s * s + r * r) * over * over);
                const TriangleCorners elastic = membraneForces(e, x);
                const TriangleCorners damping = stiffnessTimes(tangent, firstThree(all.at(all.v, lane)));
                const TriangleCorners change = stiffnessTimes(tangent, firstThree(all.at(all.p, lane)));
                for (std::size_t i = 0; i < 3; ++i) {
                    force[i] = kWeights.force * elastic[i] - kWeights.stiffness * damping[i];
                    product[i] = kWeights.stiffness * change[i];
                }
            }
            for (int i = 0; i < 3; ++i)
                for (int c = 0; c < 3; ++c) {
                    forces.compare(static_cast<float>(Triangles::corner(all.stretching, lane, i, 3)[c]),
                                   force[static_cast<std::size_t>(i)][c], lane < all.count ? 50.0 : 0.0);
                    products.compare(static_cast<float>(Triangles::corner(all.stretched, lane, i, 3)[c]),
                                     product[static_cast<std::size_t>(i)][c], size);
                }
        }
        CHECK(forces.roundings() <= 8);
        CHECK(products.roundings() <= 8);
    });
}

TEST_CASE("blocks of triangles match the double-precision bending, with two and three neighbours")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(21);
        Triangles all(random, 16 * 6 - 3);
        all.run(0, all.blocks);
        WorstError forces, products;
        for (int lane = 0; lane < kBlock * all.blocks; ++lane) {
            BendingCorners force{}, product{};
            double size = 0.0;
            if (lane < all.count) {
                const BendingElement& e = all.bends[static_cast<std::size_t>(lane)];
                const BendingCorners x = all.at(all.x, lane);
                const BendingTangent tangent = bendingTangent(e, x);
                size = kWeights.stiffness * sizeOf(tangent, 6);
                const BendingCorners elastic = bendingForces(e, x);
                const BendingCorners damping = stiffnessTimes(tangent, all.at(all.v, lane));
                const BendingCorners change = stiffnessTimes(tangent, all.at(all.p, lane));
                for (std::size_t i = 0; i < 6; ++i) {
                    force[i] = kWeights.force * elastic[i] - kWeights.stiffness * damping[i];
                    product[i] = kWeights.stiffness * change[i];
                }
            }
            for (int i = 0; i < 6; ++i)
                for (int c = 0; c < 3; ++c) {
                    forces.compare(static_cast<float>(Triangles::corner(all.bending, lane, i, 6)[c]),
                                   force[static_cast<std::size_t>(i)][c], lane < all.count ? 50.0 : 0.0);
                    products.compare(static_cast<float>(Triangles::corner(all.bent, lane, i, 6)[c]),
                                     product[static_cast<std::size_t>(i)][c], size);
                }
        }
        CHECK(forces.roundings() <= 8);
        CHECK(products.roundings() <= 8);
    });
}

TEST_CASE("the rotation of a triangle that only turned is that turn, by any angle")
{
    std::mt19937 random(22);
    Triangles all(random, 16 * 5);
    all.run(0, all.blocks);
    for (int t = 0; t < all.count; t += 5) {
        const float* q = all.quaternions.data() + t / kBlock * 64 + linalg::laneOffset(t % kBlock);
        const Mat3 turn = toMat3(Quat{q[3], q[0], q[1], q[2]});
        const BendingCorners& rest = all.rests[static_cast<std::size_t>(t)];
        for (int i = 1; i < 3; ++i)
            CHECK(distance(turn * (rest[static_cast<std::size_t>(i)] - rest[0]),
                           vectorOf(all.x[6 * t + i]) - vectorOf(all.x[6 * t])) < 1e-5);
    }
}

TEST_CASE("blocks of triangles outside the range stay, and targets with fused multiply-add give the same bits")
{
    linalg::checkSameBitsWhereFused([] {
        std::mt19937 random(23);
        Triangles all(random, 16 * 5);
        all.run(1, 4);
        std::vector<std::uint64_t> bits;
        for (const NodeArray* array : {&all.stretching, &all.stretched, &all.bending, &all.bent, &all.quaternions}) {
            const int corners = array->blocks() / all.blocks;
            for (int lane = 0; lane < 16 * 5; ++lane)
                if (lane < 16 || lane >= 64) CHECK(Triangles::corner(*array, lane, 0, corners) == Vec3{});
            bits.push_back(hashOf(*array));
        }
        return bits;
    });
}

} // namespace shell_blocks_test
