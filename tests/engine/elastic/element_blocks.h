#pragma once

#include "filasofia/core/hash.h"
#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/engine/elastic/fibre.h"
#include "filasofia/engine/elastic/spring_blocks.h"

#include "engine/elastic/laws.h"
#include "engine/meshes.h"
#include "linalg/random_matrix.h"

#include <cstring>
#include <optional>

/// Helpers of the tests of element and spring kernels. Tolerances are counts of float roundings (WorstError). The
/// references start from the same floats and compute in double.
namespace filasofia::engine {

using linalg::NodeArray;
using linalg::onEveryTarget;
using linalg::vectorOf;
using linalg::WorstError;

constexpr BlockWeights kWeights{
    .force = 0.8f, .stiffness = 0.03f, .damping = 0.5f, .turning = 0.7f, .fibreStiffness = 0.05f, .fibreTurning = 0.6f};

inline double inFloat(double value) { return static_cast<double>(static_cast<float>(value)); }
inline Vec3 inFloat(Vec3 v) { return {inFloat(v.x), inFloat(v.y), inFloat(v.z)}; }
inline void store(Vec3 v, float* out)
{
    for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(v[i]);
}

/// A tetrahedron of random shape, not too flat. Its gradients are rounded to float.
inline FemElement randomElement(std::mt19937& random, double poissonRatio)
{
    Corners rest;
    double volume = 0.0;
    while (volume < 0.05) {
        for (Vec3& each : rest) each = randomVec3(random, 1.0);
        volume = geometry::signedVolume(rest[0], rest[1], rest[2], rest[3]);
    }
    FemElement element{.nodes = {},
                       .gradients = shapeGradients(rest),
                       .volume = volume,
                       .youngModulus = 1.0 + std::abs(randomVec3(random, 1.0).x),
                       .poissonRatio = poissonRatio};
    for (std::size_t k = 1; k < 4; ++k) element.gradients[k] = inFloat(element.gradients[k]);
    element.gradients[0] = -(element.gradients[1] + element.gradients[2] + element.gradients[3]);
    return element;
}

/// Elements without common nodes: element e has nodes 4 e ... 4 e + 3.
struct Elements {
    explicit Elements(const std::vector<FemElement>& all, const physics::ElasticLaw& chosen = physics::Corotational{})
        : law(chosen), elements(all), blocks(linalg::blocksFor(static_cast<int>(all.size()))), x(4 * blocks), v(x),
          p(x), elementBlocks(static_cast<std::size_t>(blocks)), rotations(elementBlocks.size()),
          tangents(makeTangents(law, elementBlocks.size())), inverted(elementBlocks.size()),
          strains(kBlock * inverted.size()), corners(4 * blocks), products(4 * blocks), quaternions(blocks)
    {
        const int count = static_cast<int>(all.size());
        for (int lane = 0; lane < kBlock * blocks; ++lane) {
            const int element = std::min(lane, count - 1), l = lane % kBlock;
            const FemElement& e = all[static_cast<std::size_t>(element)];
            ElementBlock& block = elementBlocks[static_cast<std::size_t>(lane / kBlock)];
            for (int i = 0; i < 4; ++i) block.nodes[i][l] = 4 * (4 * element + i);
            for (int k = 0; k < 9; ++k)
                block.gradients[k][l] = static_cast<float>(e.gradients[static_cast<std::size_t>(1 + k / 3)][k % 3]);
            const auto [mu, lambda] = lameOf(e);
            block.mu[l] = lane < count ? static_cast<float>(e.volume * mu) : 0.0f;
            block.ratio[l] = static_cast<float>(lambda / mu);
        }
    }

    /// Adds a family of fibres with a random direction in most elements.
    void addFibres(const physics::FibreFamily& family, std::mt19937& random)
    {
        families.push_back(family);
        fibreBlocks.resize(families.size() * elementBlocks.size());
        fibreTangents.resize(fibreBlocks.size());
        std::vector<Vec3>& along = directions.emplace_back();
        for (int e = 0; e < count(); ++e) {
            const Vec3 d = randomVec3(random, 1.0);
            along.push_back(e % 7 == 3 ? Vec3{} : 1.0 / length(d) * d);
            const FemElement& element = elements[static_cast<std::size_t>(e)];
            const Mat3 h = structureTensor(family.dispersion, along.back());
            FibreBlock& block =
                fibreBlocks[fibreBlocks.size() - elementBlocks.size() + static_cast<std::size_t>(e / kBlock)];
            for (std::size_t i = 1, k = 0; i < 4; ++i)
                for (std::size_t j = i; j < 4; ++j, ++k)
                    block.structure[k][e % kBlock] =
                        static_cast<float>(dot(element.gradients[i], h * element.gradients[j]));
            block.volume[e % kBlock] = along.back() == Vec3{} ? 0.0f : static_cast<float>(element.volume);
        }
    }

    /// Moves nodes 1, 2, 3 by f around node 0.
    void deform(int element, const Mat3& f, Vec3 origin = {})
    {
        const Corners& g = elements[static_cast<std::size_t>(element)].gradients;
        const Mat3 edges = inverse(Mat3{{g[1], g[2], g[3]}}); // its columns are the edges
        store(origin, x[4 * element]);
        for (int k = 0; k < 3; ++k) store(origin + f * edges.column(k), x[4 * element + k + 1]);
    }

    void run()
    {
        updateElements(law, elementBlocks, {x, v, kWeights, step ? &*step : nullptr}, {0, blocks}, output());
        multiplyElements(tangents, fibreTangents, p, floats(products), {0, blocks});
    }
    [[nodiscard]] ElementOutput output()
    {
        return {.rotations = rotations,
                .tangents = tangents,
                .inverted = inverted,
                .strains = strains,
                .corners = floats(corners),
                .quaternions = floats(quaternions),
                .relaxation = relaxation,
                .fibres = {families, fibreBlocks, fibreTangents}};
    }

    static std::span<float> floats(NodeArray& a) { return {a.data(), 64 * static_cast<std::size_t>(a.blocks())}; }
    [[nodiscard]] int count() const { return static_cast<int>(elements.size()); }
    [[nodiscard]] Quat rotation(int element) const
    {
        const ElementRotations& r = rotations[static_cast<std::size_t>(element / kBlock)];
        const int l = element % kBlock;
        return {r.w[l], r.x[l], r.y[l], r.z[l]};
    }
    /// The entry of `array` for node i of the element of a lane.
    static const float* corner(const NodeArray& array, int lane, int i)
    {
        return array.data() + lane / kBlock * kElementCorners + 64 * i + linalg::laneOffset(lane % kBlock);
    }
    static Corners nodes(const NodeArray& array, int element)
    {
        Corners all;
        for (int i = 0; i < 4; ++i) all[static_cast<std::size_t>(i)] = vectorOf(array[4 * element + i]);
        return all;
    }

    physics::ElasticLaw law;
    std::vector<FemElement> elements;
    int blocks;
    NodeArray x, v, p;
    std::vector<ElementBlock> elementBlocks;
    std::vector<ElementRotations> rotations;
    ElementTangents tangents;
    std::vector<std::uint16_t> inverted;
    std::vector<float> strains;
    NodeArray corners, products, quaternions;
    std::vector<physics::FibreFamily> families;
    std::vector<std::vector<Vec3>> directions; ///< per family and element
    std::vector<FibreBlock> fibreBlocks;
    std::vector<FibreTangentBlock> fibreTangents;
    std::optional<RelaxationStep> step;
    std::vector<ElementRelaxation> relaxation;
};

inline std::vector<FemElement> randomElements(std::mt19937& random, int count, double poissonRatio)
{
    std::vector<FemElement> all;
    while (static_cast<int>(all.size()) < count) all.push_back(randomElement(random, poissonRatio));
    return all;
}

inline void randomMotion(std::mt19937& random, Elements& all)
{
    all.v = linalg::randomNodes(random, 4 * all.count());
    all.p = linalg::randomNodes(random, 4 * all.count());
    for (NodeArray* each : {&all.v, &all.p}) // over the nodes of all lanes
        if (each->blocks() != all.x.blocks()) {
            NodeArray larger(all.x.blocks());
            std::copy(each->data(), each->data() + 64 * each->blocks(), larger.data());
            *each = larger;
        }
}

/// Hash of the bits of blocks of numbers.
template <class Block> std::uint64_t hashOf(const Block* blocks, std::size_t count)
{
    Hasher hash;
    for (std::size_t at = 0; at < count * sizeof(Block); at += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, reinterpret_cast<const char*>(blocks) + at, sizeof word);
        hash.add(word);
    }
    return hash.value();
}
inline std::uint64_t hashOf(const NodeArray& nodes)
{
    return hashOf(nodes.data(), 64 * static_cast<std::size_t>(nodes.blocks()));
}

} // namespace filasofia::engine
