#pragma once

#include "filasofia/linalg/node_array.h"
#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// What resists the change of one quantity, and nothing else, adds to the matrix of a step: weight times g g^T, where g
/// is the gradient of the quantity: the volume of a cavity.
struct RankOneStiffness {
    std::vector<int> nodes;     ///< those that change it, ascending
    std::vector<Vec3> gradient; ///< [m^2] per node
    double weight = 0.0;        ///< [kg/m^4], h^2 times the growth of what resists
};

/// All of a body for the default solver, in its scaling and on its slots.
class CavitySystem {
public:
    /// `slotOf`: per node; slots from `freeNodes` on are pinned. `scale` [1/kg].
    void set(std::span<const RankOneStiffness> cavities, std::span<const int> slotOf, int freeNodes, double scale);
    /// q += W p; returns p . W p.
    double multiply(const linalg::NodeArray& p, linalg::NodeArray& q) const;
    [[nodiscard]] double curvature(const linalg::NodeArray& p) const; ///< p . W p

private:
    struct Entry {
        int slot = 0;
        Vec3 gradient;
    };
    struct Row {
        std::vector<Entry> entries;
        double weight = 0.0;
    };
    std::vector<Row> rows_;
};

} // namespace filasofia::engine
