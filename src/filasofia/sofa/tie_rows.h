#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/behavior/PairInteractionConstraint.h>

#include <array>
#include <span>
#include <vector>

namespace filasofia::sofaengine {

/// A point of a body as a weighted mean of four nodes of a state; a node counts itself with weight 1.
struct TiePoint {
    std::array<int, 4> nodes = {0, 0, 0, 0};
    std::array<double, 4> weights = {1, 0, 0, 0};
};
/// Whether a point of a soft body depends on one of these nodes (per node, 1).
inline bool dependsOn(const TiePoint& point, const std::vector<char>& nodes)
{
    for (std::size_t k = 0; k < 4; ++k)
        if (point.weights[k] != 0.0 && nodes[static_cast<std::size_t>(point.nodes[k])] != 0) return true;
    return false;
}

/// Pairs of points of two states that are held together, or points of one that are held in space: constraints of SOFA
/// with a compliance, so that a spring is as exact as a weld.
class TieRows final : public ::sofa::core::behavior::PairInteractionConstraint<Vec3Types> {
public:
    SOFA_CLASS(TieRows, SOFA_TEMPLATE(::sofa::core::behavior::PairInteractionConstraint, Vec3Types));
    using States = ::sofa::core::behavior::MechanicalState<Vec3Types>;
    TieRows(States* first, States* second) : PairInteractionConstraint(first, second) {}

    struct Pair {
        TiePoint first = {};
        TiePoint second = {}; ///< unless space holds the first
        Vec3 apart = {};      ///< [m] how far the first is held from the second, or from the origin of space
        Vec3 force = {};      ///< [N] on the first, in the last step
        unsigned row = 0;
    };
    std::vector<Pair> pairs = {};
    bool space = false;     ///< the second state does not count
    double stiffness = 0.0; ///< [N/m] each pair's; infinite: a weld
    double fastest = 0.0;   ///< [m/s] at which a weld draws its points together

    /// Before a step of dt [s]: welds close what is between their points.
    void draw(double dt);
    /// After a step: the forces. `impulses`: those by all constraints [N s].
    void readForces(std::span<const double> impulses, double dt);

    void buildConstraintMatrix(const ::sofa::core::ConstraintParams* params, DataMatrixDeriv& first,
                               DataMatrixDeriv& second, unsigned int& row, const DataVecCoord& x1,
                               const DataVecCoord& x2) override;
    void getConstraintViolation(const ::sofa::core::ConstraintParams* params, ::sofa::linearalgebra::BaseVector* out,
                                const DataVecCoord& x1, const DataVecCoord& x2, const DataVecDeriv& v1,
                                const DataVecDeriv& v2) override;
    void getConstraintResolution(const ::sofa::core::ConstraintParams* params,
                                 std::vector<::sofa::core::behavior::ConstraintResolution*>& all,
                                 unsigned int& offset) override;
    ::sofa::type::vector<std::string> getPairInteractionIdentifiers() override { return {"Tie"}; }
    using PairInteractionConstraint::buildConstraintMatrix;
    using PairInteractionConstraint::getConstraintViolation;
};

} // namespace filasofia::sofaengine
