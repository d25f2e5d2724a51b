#include "filasofia/engine/elastic/element.h"

namespace filasofia::engine {

Corners shapeGradients(const Corners& rest)
{
    // The rows of the inverse of the edge matrix are the gradients of nodes 1, 2, 3; the four sum to zero.
    const Mat3 edges = Mat3::columns(rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0]);
    const Mat3 rows = inverse(edges);
    return {-(rows[0] + rows[1] + rows[2]), rows[0], rows[1], rows[2]};
}

Mat3 gradient(const FemElement& element, const Corners& x)
{
    // Relative to node 0, so that a translation of any size changes nothing.
    Mat3 sum;
    for (int i = 1; i < 4; ++i) sum += outer(x[i] - x[0], element.gradients[i]);
    return sum;
}

Corners internalForces(const FemElement& element, const Mat3& stress)
{
    Corners forces;
    for (int i = 0; i < 4; ++i) forces[i] = element.volume * (stress * element.gradients[i]);
    return forces;
}

} // namespace filasofia::engine
