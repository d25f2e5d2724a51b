#include "filasofia/sofa/joint_rows.h"

#include <sofa/core/ConstraintParams.h>
#include <sofa/core/behavior/ConstraintResolution.h>
#include <sofa/linearalgebra/BaseVector.h>

#include <algorithm>

namespace filasofia::sofaengine {
namespace {

/// One line whose gap closes as far as the bounds of its impulse allow.
class BoundedResolution final : public ::sofa::core::behavior::ConstraintResolution {
public:
    BoundedResolution(double low, double high) : ConstraintResolution(1), low_(low), high_(high) {}
    void resolution(int line, SReal** w, SReal* d, SReal* force, SReal* /*free*/) override
    {
        if (w[line][line] > 0.0) force[line] = std::clamp(force[line] - d[line] / w[line][line], low_, high_);
    }

private:
    double low_, high_; ///< [N s]
};

} // namespace

std::span<const double> JointRows::impulsesOf(std::span<const double> all) const
{
    const std::size_t count = joints_.rows().size();
    return first_ + count <= all.size() ? all.subspan(first_, count) : std::span<const double>();
}

void JointRows::buildConstraintMatrix(const ::sofa::core::ConstraintParams* /*params*/, DataMatrixDeriv& first,
                                      DataMatrixDeriv& /*second*/, unsigned int& row, const DataVecCoord& /*x1*/,
                                      const DataVecCoord& /*x2*/)
{
    first_ = row;
    ::sofa::helper::WriteAccessor matrix(first);
    for (const Articulation::Row& each : joints_.rows()) {
        auto line = matrix.wref().writeLine(row++);
        for (const auto& [link, impulse] : joints_.partsOf(each)) line.addCol(link, impulse);
    }
}

void JointRows::getConstraintViolation(const ::sofa::core::ConstraintParams* /*params*/,
                                       ::sofa::linearalgebra::BaseVector* out, const DataVecCoord& /*x1*/,
                                       const DataVecCoord& /*x2*/, const DataVecDeriv& /*v1*/,
                                       const DataVecDeriv& /*v2*/)
{
    for (std::size_t r = 0; r < joints_.rows().size(); ++r)
        out->set(static_cast<::sofa::SignedIndex>(first_ + r), joints_.rows()[r].gap);
}

void JointRows::getConstraintResolution(const ::sofa::core::ConstraintParams* /*params*/,
                                        std::vector<::sofa::core::behavior::ConstraintResolution*>& all,
                                        unsigned int& offset)
{
    for (const Articulation::Row& each : joints_.rows())
        all[offset++] = new BoundedResolution(each.low, each.high); // SOFA deletes it
}

} // namespace filasofia::sofaengine
