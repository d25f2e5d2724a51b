#include "filasofia/sofa/tie_rows.h"

#include "filasofia/math/mat3.h"

#include <sofa/core/ConstraintParams.h>
#include <sofa/core/behavior/ConstraintResolution.h>
#include <sofa/linearalgebra/BaseVector.h>

#include <cmath>

namespace filasofia::sofaengine {
namespace {

/// Three lines at once: the gap that is left is the compliance times the force.
class TieResolution final : public ::sofa::core::behavior::ConstraintResolution {
public:
    explicit TieResolution(double compliance) : ConstraintResolution(3), compliance_(compliance) {}
    void resolution(int line, SReal** w, SReal* d, SReal* force, SReal* /*free*/) override
    {
        Mat3 a;
        Vec3 gap;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) a[i][j] = w[line + i][line + j] + (i == j ? compliance_ : 0.0);
            (&gap.x)[i] = d[line + i] + compliance_ * force[line + i];
        }
        if (!(determinant(a) > 0.0)) return; // nothing there can move
        const Vec3 change = inverse(a) * gap;
        for (int i = 0; i < 3; ++i) force[line + i] -= (&change.x)[i];
    }

private:
    double compliance_; ///< [m/(N s)]
};

template <class Positions>::sofa::type::Vec3 placeOf(const TiePoint& point, const Positions& x)
{
    ::sofa::type::Vec3 place;
    for (std::size_t i = 0; i < 4; ++i)
        if (point.weights[i] != 0.0) place += x[static_cast<std::size_t>(point.nodes[i])] * point.weights[i];
    return place;
}

template <class Matrix> void addLine(const TiePoint& point, unsigned row, int axis, double sign, Matrix& matrix)
{
    auto line = matrix.writeLine(row);
    for (std::size_t i = 0; i < 4; ++i) {
        if (point.weights[i] == 0.0) continue;
        Vec3Types::Deriv along;
        along[static_cast<std::size_t>(axis)] = sign * point.weights[i];
        line.addCol(point.nodes[i], along);
    }
}

} // namespace

void TieRows::draw(double dt)
{
    if (std::isfinite(stiffness) || space) return;
    for (Pair& each : pairs) {
        const double far = length(each.apart), way = fastest * dt;
        each.apart = far <= way ? Vec3{} : (1.0 - way / far) * each.apart;
    }
}

void TieRows::readForces(std::span<const double> impulses, double dt)
{
    for (Pair& each : pairs) {
        each.force = {};
        if (each.row + 3 <= impulses.size())
            each.force = Vec3{impulses[each.row], impulses[each.row + 1], impulses[each.row + 2]} / dt;
    }
}

void TieRows::buildConstraintMatrix(const ::sofa::core::ConstraintParams* /*params*/, DataMatrixDeriv& first,
                                    DataMatrixDeriv& second, unsigned int& row, const DataVecCoord& /*x1*/,
                                    const DataVecCoord& /*x2*/)
{
    for (Pair& each : pairs) {
        each.row = row;
        for (int axis = 0; axis < 3; ++axis) {
            {
                ::sofa::helper::WriteAccessor matrix(first);
                addLine(each.first, row, axis, 1.0, matrix.wref());
            }
            if (!space) {
                ::sofa::helper::WriteAccessor matrix(second);
                addLine(each.second, row, axis, -1.0, matrix.wref());
            }
            ++row;
        }
    }
}

void TieRows::getConstraintViolation(const ::sofa::core::ConstraintParams* params,
                                     ::sofa::linearalgebra::BaseVector* out, const DataVecCoord& /*x1*/,
                                     const DataVecCoord& /*x2*/, const DataVecDeriv& /*v1*/, const DataVecDeriv& /*v2*/)
{
    const auto& x1 = params->readX(mstate1.get())->getValue();
    const auto& x2 = params->readX(mstate2.get())->getValue();
    for (const Pair& each : pairs) {
        ::sofa::type::Vec3 gap = placeOf(each.first, x1) - toSofa(each.apart);
        if (!space) gap -= placeOf(each.second, x2);
        for (unsigned axis = 0; axis < 3; ++axis) out->set(each.row + axis, gap[axis]);
    }
}

void TieRows::getConstraintResolution(const ::sofa::core::ConstraintParams* /*params*/,
                                      std::vector<::sofa::core::behavior::ConstraintResolution*>& all,
                                      unsigned int& offset)
{
    const double compliance = std::isfinite(stiffness) ? 1.0 / (stiffness * getContext()->getDt()) : 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        all[offset] = new TieResolution(compliance); // SOFA deletes it
        offset += 3;
    }
}

} // namespace filasofia::sofaengine
