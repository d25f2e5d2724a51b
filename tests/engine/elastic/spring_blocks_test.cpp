#include "filasofia/engine/elastic/spring.h"

#include "engine/elastic/element_blocks.h"

namespace spring_blocks_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Springs without common nodes: random, compressed, stretched, and with coincident ends.
struct Springs {
    Springs(std::mt19937& random, int count)
        : blocks(linalg::blocksFor(count)), x(2 * blocks), v(linalg::randomNodes(random, 32 * blocks)),
          p(linalg::randomNodes(random, 32 * blocks)), springBlocks(static_cast<std::size_t>(blocks)),
          matrices(springBlocks.size()), corners(2 * blocks), products(2 * blocks)
    {
        for (int lane = 0; lane < kBlock * blocks; ++lane) {
            const int s = std::min(lane, count - 1), l = lane % kBlock;
            if (lane < count) {
                springs.push_back({.nodes = {2 * s, 2 * s + 1},
                                   .restLength = inFloat(0.5 + std::abs(randomVec3(random, 1.0).x)),
                                   .stiffness = inFloat(1.0 + std::abs(randomVec3(random, 9.0).x)),
                                   .damping = s % 2 ? 0.0 : inFloat(std::abs(randomVec3(random, 2.0).x))});
                const Vec3 a = randomVec3(random, 1.0), direction = normalized(randomVec3(random, 1.0));
                const double stretches[4] = {0.0, 0.3, 1.0, 2.5};
                store(a, x[2 * s]);
                store(vectorOf(x[2 * s]) + stretches[s % 4] * springs.back().restLength * direction, x[2 * s + 1]);
            }
            const Spring& spring = springs[static_cast<std::size_t>(s)];
            SpringBlock& block = springBlocks[static_cast<std::size_t>(lane / kBlock)];
            SpringMatrixBlock& matrix = matrices[static_cast<std::size_t>(lane / kBlock)];
            for (int i = 0; i < 2; ++i) block.nodes[i][l] = matrix.nodes[i][l] = 4 * (2 * s + i);
            block.restLength[l] = static_cast<float>(spring.restLength);
            block.stiffness[l] = lane < count ? static_cast<float>(spring.stiffness) : 0.0f;
            block.damping[l] = lane < count ? static_cast<float>(spring.damping) : 0.0f;
        }
    }
    void run(int begin, int end)
    {
        updateSprings(springBlocks, {x, v, kWeights}, {begin, end}, {matrices, Elements::floats(corners)});
        multiplySprings(matrices, p, Elements::floats(products), {begin, end});
    }
    static const float* corner(const NodeArray& array, int lane, int i)
    {
        return array.data() + lane / kBlock * kSpringCorners + 64 * i + linalg::laneOffset(lane % kBlock);
    }

    int blocks;
    NodeArray x, v, p;
    std::vector<Spring> springs;
    std::vector<SpringBlock> springBlocks;
    std::vector<SpringMatrixBlock> matrices;
    NodeArray corners, products;
};

} // namespace

TEST_CASE("blocks of springs match the double-precision spring if separate, coincident, compressed or damped")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(10);
        Springs all(random, 16 * 6 - 3);
        all.run(0, all.blocks);
        WorstError forces, products;
        for (int lane = 0; lane < kBlock * all.blocks; ++lane) {
            Vec3 force, product;
            double forceSize = 0.0, productSize = 0.0;
            if (lane < static_cast<int>(all.springs.size())) {
                const Spring& s = all.springs[static_cast<std::size_t>(lane)];
                const Vec3 a = vectorOf(all.x[2 * lane]), b = vectorOf(all.x[2 * lane + 1]);
                const Mat3 m =
                    kWeights.stiffness * springStiffness(s, a, b) + kWeights.damping * springDamping(s, a, b);
                const Vec3 rate = vectorOf(all.v[2 * lane]) - vectorOf(all.v[2 * lane + 1]);
                const Vec3 direction = vectorOf(all.p[2 * lane]) - vectorOf(all.p[2 * lane + 1]);
                force = kWeights.force * springForce(s, a, b) - m * rate;
                product = m * direction;
                const double size = kWeights.stiffness * s.stiffness + kWeights.damping * s.damping;
                forceSize = kWeights.force * s.stiffness * (distance(a, b) + s.restLength) + size * length(rate);
                productSize = size * length(direction);
            }
            for (int i = 0; i < 2; ++i)
                for (int c = 0; c < 4; ++c) {
                    const double sign = i == 0 ? 1.0 : -1.0;
                    forces.compare(Springs::corner(all.corners, lane, i)[c], c < 3 ? sign * force[c] : 0.0, forceSize);
                    products.compare(Springs::corner(all.products, lane, i)[c], c < 3 ? sign * product[c] : 0.0,
                                     productSize);
                }
        }
        CHECK(forces.roundings() <= 8);
        CHECK(products.roundings() <= 8);
    });
}

TEST_CASE("blocks of springs outside the range stay, and targets with fused multiply-add give the same bits")
{
    linalg::checkSameBitsWhereFused([] {
        std::mt19937 random(11);
        Springs all(random, 16 * 5);
        all.run(1, 4);
        std::vector<std::uint64_t> bits;
        for (const NodeArray* array : {&all.corners, &all.products}) {
            for (int lane = 0; lane < 16 * 5; ++lane)
                if (lane < 16 || lane >= 64) CHECK(vectorOf(Springs::corner(*array, lane, 0)) == Vec3{});
            bits.push_back(hashOf(*array));
        }
        return bits;
    });
}

} // namespace spring_blocks_test
