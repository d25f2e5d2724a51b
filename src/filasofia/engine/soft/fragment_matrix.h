#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/integration/euler.h"

#include <array>
#include <utility>
#include <vector>

namespace filasofia::engine {

/// The matrix of an implicit step for one small piece, in double. Its nodes are numbered by their places in the piece's
/// list.
class FragmentMatrix {
public:
    /// dt > 0 [s].
    FragmentMatrix(const SoftModel& model, const BodyPiece& piece, double dt, const SoftState& state);

    [[nodiscard]] std::size_t nodes() const { return masses_.size(); }
    [[nodiscard]] std::vector<double> entries() const; ///< [kg] three rows and columns per node, row by row
    [[nodiscard]] double mass() const;                 ///< [kg] weighed, of all nodes

private:
    struct Part {
        const FemElement* element = nullptr;
        TissueTangent tangent;
        std::array<std::size_t, 4> places{};
    };
    void addTriangle(const Shell& shell, std::size_t e, const BodyPiece& piece, ImplicitWeights weights,
                     const SoftState& state);

    double stiffness_ = 0.0; ///< weight of the stiffness
    std::vector<double> masses_;
    std::vector<Part> parts_;
    std::vector<std::pair<std::array<std::size_t, 3>, MembraneTangent>> membranes_;
    std::vector<std::pair<std::array<std::size_t, 6>, BendingTangent>> bends_;
};

} // namespace filasofia::engine
