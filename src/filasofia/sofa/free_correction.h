#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include <sofa/core/ConstraintParams.h>
#include <sofa/core/behavior/ConstraintCorrection.inl>
#include <sofa/linearalgebra/BaseMatrix.h>

#include <algorithm>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace filasofia::sofaengine {

/// How impulses of constraints move a body whose answer is known without a solver of SOFA's: rigid elements, links of
/// joints, and nodes that are integrated explicitly. Without `respond` they do not move it: a kinematic body, or one
/// that nothing touches. SOFA moves a body with constraints in the scene only if it has such a component.
template <class Types> class FreeCorrection final : public ::sofa::core::behavior::ConstraintCorrection<Types> {
public:
    SOFA_CLASS(SOFA_TEMPLATE(FreeCorrection, Types),
               SOFA_TEMPLATE(::sofa::core::behavior::ConstraintCorrection, Types));
    using Deriv = typename Types::Deriv;
    using Coords = ::sofa::Data<typename Types::VecCoord>;
    using Derivs = ::sofa::Data<typename Types::VecDeriv>;
    using Params = ::sofa::core::ConstraintParams;

    using Part = std::pair<int, Deriv>; ///< a node, and an impulse on it or a change of its velocity
    using Response = std::function<std::vector<Part>(std::span<const Part> impulses, double dt)>;
    Response respond = {}; ///< the changes of velocity by impulses, in a step of dt [s]
    Response push = {};    ///< the same where they are those of the step; none: `respond`

    /// Nodes that do not act on each other within a step.
    static Response eachAlone(std::function<Deriv(std::size_t node, const Deriv& impulse, double dt)> answer)
    {
        return [answer = std::move(answer)](std::span<const Part> impulses, double dt) {
            std::vector<Part> moved;
            for (const auto& [node, impulse] : impulses)
                moved.emplace_back(node, answer(static_cast<std::size_t>(node), impulse, dt));
            return moved;
        };
    }

    void addComplianceInConstraintSpace(const Params* params, ::sofa::linearalgebra::BaseMatrix* w) override
    {
        if (!respond) return;
        const double dt = this->getContext()->getDt();
        const auto& jacobian = params->readJ(this->mstate.get())->getValue();
        for (auto row = jacobian.begin(); row != jacobian.end(); ++row) {
            std::vector<Part> impulses;
            for (auto at = row.begin(); at != row.end(); ++at) impulses.emplace_back(at.index(), at.val());
            for (const auto& [node, change] : respond(impulses, dt))
                addRow(jacobian, node, change * dt, row.index(), w);
        }
    }
    void computeMotionCorrection(const Params* /*params*/, ::sofa::core::MultiVecDerivId dx,
                                 ::sofa::core::MultiVecDerivId f) override
    {
        const double dt = this->getContext()->getDt();
        ::sofa::helper::WriteAccessor change(*dx[this->mstate.get()].write());
        const auto& impulse = f[this->mstate.get()].read()->getValue();
        change.resize(impulse.size());
        std::fill(change.begin(), change.end(), Deriv());
        if (!respond) return;
        std::vector<Part> impulses;
        // Zeros too: SOFA's vectors count as equal within 1e-6, which is more than a node's impulse.
        for (std::size_t i = 0; i < impulse.size(); ++i) impulses.emplace_back(static_cast<int>(i), impulse[i]);
        for (const auto& [node, moved] : (push ? push : respond)(impulses, dt)) change[std::size_t(node)] = moved;
    }
    void applyMotionCorrection(const Params* params, Coords& x, Derivs& v, Derivs& dx, const Derivs& change) override
    {
        // SOFA passes the same list as dx and as change: the velocity comes first.
        ::sofa::helper::WriteAccessor velocity(v);
        const auto& free = params->readV(this->mstate.get())->getValue();
        for (std::size_t i = 0; i < free.size(); ++i) velocity[i] = free[i] + change.getValue()[i];
        applyPositionCorrection(params, x, dx, change);
    }
    void applyPositionCorrection(const Params* params, Coords& x, Derivs& dx, const Derivs& change) override
    {
        const double dt = this->getContext()->getDt();
        ::sofa::helper::WriteAccessor position(x);
        ::sofa::helper::WriteAccessor way(dx);
        const auto& free = params->readX(this->mstate.get())->getValue();
        way.resize(free.size());
        for (std::size_t i = 0; i < free.size(); ++i) {
            way[i] = change.getValue()[i] * dt;
            position[i] = free[i] + way[i];
        }
    }
    void applyVelocityCorrection(const Params* params, Derivs& v, Derivs& dv, const Derivs& change) override
    {
        ::sofa::helper::WriteAccessor velocity(v);
        const auto& free = params->readV(this->mstate.get())->getValue();
        for (std::size_t i = 0; i < free.size(); ++i) velocity[i] = free[i] + change.getValue()[i];
        dv.setValue(change.getValue());
    }
    void getComplianceMatrix(::sofa::linearalgebra::BaseMatrix* /*m*/) const override {} // nobody asks
    void applyContactForce(const ::sofa::linearalgebra::BaseVector* /*f*/) override {}   // nobody asks
    void resetContactForce() override {}
    using ::sofa::core::behavior::ConstraintCorrection<Types>::applyMotionCorrection;
    using ::sofa::core::behavior::ConstraintCorrection<Types>::applyPositionCorrection;
    using ::sofa::core::behavior::ConstraintCorrection<Types>::applyVelocityCorrection;

private:
    /// The motion of a node, seen in every constraint that it has a part in.
    template <class Jacobian> static void addRow(const Jacobian& jacobian, int node, const Deriv& moved, int line,
                                                 ::sofa::linearalgebra::BaseMatrix* w)
    {
        for (auto row = jacobian.begin(); row != jacobian.end(); ++row)
            for (auto at = row.begin(); at != row.end(); ++at)
                if (at.index() == node) w->add(row.index(), line, at.val() * moved);
    }
};

} // namespace filasofia::sofaengine
