#pragma once

#include "filasofia/linalg/node_kernels.h"
#include "filasofia/math/mat3.h"

#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A pair of points that an attachment holds together, as coarse levels see it: by how much the two move apart per
/// velocity of the coarse nodes that they follow, at rest.
struct TiedPair {
    struct Part {
        std::size_t node = 0; ///< among the picked coarse nodes of all bodies
        Mat3 g;               ///< [-]
    };
    std::vector<Part> parts;
    double stiffness = 0.0; ///< [kg] what the pair keeps for the coarse level after the smoother has yielded, > 0
};

/// The coarse levels B of soft bodies that are attached to each other, corrected as if they were one:
///
///     B' = (B^-1 + E H E^T)^-1 = B - B E W E^T B,   H = G^T M G,   W = (H^-1 + E^T B E)^-1
///
/// E picks the coarse nodes that attached points follow, G are the pairs' parts and M their stiffness (Woodbury's
/// formula). As all of that is at rest, W serves for as long as the bodies are attached; a step only multiplies by it.
/// Whatever H is, B' is symmetric and positive definite.
class TiedCoarse {
public:
    /// Largest number of picked coarse nodes: W is dense.
    static constexpr std::size_t kMaxNodes = 256;

    /// `picked[b]`: the coarse nodes of body b, numbered body by body in TiedPair. `inverse(b, i, j)` [1/kg]: the entry
    /// of B for the unknowns i and j of the body's picked nodes, 3 per node. Returns false, and leaves nothing, if
    /// there are no nodes or too many, or if B is not positive definite to rounding.
    template <class Inverse>
    bool build(std::vector<std::vector<int>> picked, std::span<const TiedPair> pairs, const Inverse& inverse)
    {
        picked_ = std::move(picked);
        count_ = 0;
        for (const std::vector<int>& nodes : picked_) count_ += nodes.size();
        if (count_ == 0 || count_ > kMaxNodes) return false;
        std::vector<double> b(9 * count_ * count_);
        std::size_t first = 0;
        for (std::size_t body = 0; body < picked_.size(); ++body) {
            const std::size_t size = 3 * picked_[body].size();
            for (std::size_t i = 0; i < size; ++i)
                for (std::size_t j = 0; j < size; ++j) b[(first + i) * 3 * count_ + first + j] = inverse(body, i, j);
            first += size;
        }
        return finish(b, pairs);
    }

    [[nodiscard]] std::span<const int> nodesOf(std::size_t body) const { return picked_[body]; }
    /// The numbers of an input of multiply() that are in use; the input has paddedSize() of them.
    [[nodiscard]] std::size_t size() const { return 3 * count_; }
    [[nodiscard]] std::size_t paddedSize() const { return (size() + 3) / 4 * 4; }
    /// The size of a result of multiply(): whole blocks of sixteen.
    [[nodiscard]] std::size_t resultSize() const;
    /// [N s] W times vectors of velocities [m/s], one after the other: 3 numbers per picked node, zeros after them.
    void multiply(std::size_t vectors, std::span<const float> velocities, std::span<float> impulses) const;

private:
    bool finish(std::span<const double> b, std::span<const TiedPair> pairs);

    std::size_t count_ = 0; ///< picked coarse nodes
    std::vector<std::vector<int>> picked_;
    std::vector<linalg::PanelRow> w_;
};

/// A TiedCoarse in a solve.
struct SolvedTie {
    const TiedCoarse* coarse = nullptr;
    std::vector<std::size_t> bodies; ///< per body of it: its index among those of the solve
};

} // namespace filasofia::engine
