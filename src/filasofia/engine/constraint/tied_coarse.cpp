#include "filasofia/engine/constraint/tied_coarse.h"

#include "filasofia/linalg/parallel_sum.h"

namespace filasofia::engine {
namespace {

/// H
std::vector<double> stiffnessOf(std::span<const TiedPair> pairs, std::size_t size)
{
    std::vector<double> h(size * size);
    for (const TiedPair& pair : pairs)
        for (const TiedPair::Part& one : pair.parts)
            for (const TiedPair::Part& two : pair.parts) {
                const Mat3 block = pair.stiffness * (transpose(one.g) * two.g);
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t k = 0; k < 3; ++k)
                        h[(3 * one.node + i) * size + 3 * two.node + k] +=
                            block[static_cast<int>(i)][static_cast<int>(k)];
            }
    return h;
}

} // namespace

bool TiedCoarse::finish(std::span<const double> b, std::span<const TiedPair> pairs)
{
    auto made = linalg::parallelSum(b, stiffnessOf(pairs, size()), static_cast<int>(size()));
    if (made) w_ = std::move(*made);
    return made.has_value();
}

std::size_t TiedCoarse::resultSize() const
{
    return static_cast<std::size_t>(linalg::kBlock * linalg::blocksFor(static_cast<int>(size())));
}

void TiedCoarse::multiply(std::size_t vectors, std::span<const float> velocities, std::span<float> impulses) const
{
    const auto rows = static_cast<int>(paddedSize());
    linalg::multiplyPanels(w_, velocities, impulses,
                           {.count = static_cast<int>(vectors),
                            .rows = rows,
                            .stride = rows,
                            .resultStride = static_cast<int>(resultSize())},
                           linalg::blocksFor(static_cast<int>(size())));
}

} // namespace filasofia::engine
