#pragma once

#include "filasofia/core/hash.h"

#include "linalg/random_matrix.h"

#include <bit>
#include <cstring>
#include <map>

/// What the tests of the loops over nodes share. Tolerances are counts of roundings (WorstError): if n products are
/// added up one after another, each may add one rounding of the sum so far, whatever the order.
namespace filasofia::linalg {

/// Calls test(blocks, range) for arrays of 1 to 40 blocks: for all of them, their middle, the last one, and an empty
/// range.
template <class Test> void onManyRanges(const Test& test)
{
    for (int blocks : {1, 2, 3, 5, 16, 17, 40})
        for (const Blocks range : {Blocks{0, blocks}, Blocks{blocks / 3, blocks - blocks / 4},
                                   Blocks{blocks - 1, blocks}, Blocks{blocks / 2, blocks / 2}}) {
            INFO(blocks << " blocks, from " << range.begin << " to " << range.end);
            test(blocks, range);
        }
}

inline NodeArray randomBlocks(std::mt19937& random, int blocks) { return randomNodes(random, kBlock * blocks); }

inline bool inside(int node, Blocks range) { return node >= kBlock * range.begin && node < kBlock * range.end; }

inline bool sameBits(const float* a, const float* b, std::size_t floats) { return std::memcmp(a, b, 4 * floats) == 0; }

/// Whether nothing outside the range has changed.
inline bool untouchedOutside(Blocks range, const NodeArray& before, const NodeArray& after)
{
    for (int node = 0; node < kBlock * before.blocks(); ++node)
        if (!inside(node, range) && !sameBits(before[node], after[node], 4)) return false;
    return true;
}

/// The exact value of a sum, and the sum of the absolute values of its terms.
struct Sum {
    double value = 0.0, size = 0.0;
    void add(double term) { value += term, size += std::abs(term); }
};

inline Sum product(const NodeArray& a, const NodeArray& b, Blocks range)
{
    Sum sum;
    for (int node = kBlock * range.begin; node < kBlock * range.end; ++node)
        for (int i = 0; i < 3; ++i) sum.add(static_cast<double>(a[node][i]) * b[node][i]);
    return sum;
}

/// Corners of elements around nodes: up to `maxCorners` for each, or none, in random places.
inline Gather randomGather(std::mt19937& random, int blocks, int elementBlocks, int maxCorners)
{
    std::vector<std::vector<int>> places(static_cast<std::size_t>(kBlock * blocks));
    for (std::vector<int>& list : places)
        for (int left = static_cast<int>(random() % (maxCorners + 1)); left > 0; --left)
            list.push_back(4 * static_cast<int>(random() % (64u * elementBlocks)));
    return Gather(places);
}

/// The floats of an array: vectors of corners or quaternions, aligned as the kernels need them.
inline std::span<const float> floats(const NodeArray& array)
{
    return {array.data(), 64 * static_cast<std::size_t>(array.blocks())};
}

inline std::vector<float> randomFloats(std::mt19937& random, std::size_t count)
{
    std::vector<float> numbers(count);
    for (float& each : numbers) each = randomFloat(random);
    return numbers;
}

inline Vec3 absolute(Vec3 v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }
inline Mat3 absolute(Mat3 m)
{
    for (int k = 0; k < 9; ++k) m[k / 3][k % 3] = std::abs(m[k / 3][k % 3]);
    return m;
}

inline void compare(WorstError& worst, const float* value, Vec3 exact, Vec3 size)
{
    for (int i = 0; i < 3; ++i) worst.compare(value[i], exact[i], size[i]);
    worst.compare(value[3], 0.0, 0.0); // the fourth float stays zero, because sums include it
}

/// The bits of results and sums, each with a name.
struct NamedBits {
    std::map<std::string, std::uint64_t> bits;
    void add(const char* name, std::span<const float> all, double sum = 0.0)
    {
        Hasher hash;
        for (float each : all) hash.add(std::uint64_t{std::bit_cast<std::uint32_t>(each)});
        hash.add(sum);
        bits[name] = hash.value();
    }
};

} // namespace filasofia::linalg
