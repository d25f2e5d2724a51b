#include "filasofia/engine/collision/element_pairs.h"

namespace filasofia::engine {
namespace {

bool isFragment(const CollisionSurface& surface, int element)
{
    return surface.pieceOf[static_cast<std::size_t>(surface.shape->elements[element].vertices[0])] < 0;
}

void collectLeafPairs(const CollisionSurface& a, const CollisionSurface& b, CollisionShape::Node na,
                      CollisionShape::Node nb, std::vector<std::array<int, 2>>& pairs)
{
    const bool same = &a == &b && na.first == nb.first, pieces = &a == &b && !a.pieceOf.empty();
    for (int i = na.first; i < na.first + na.count; ++i)
        for (int k = same ? i + 1 : nb.first; k < nb.first + nb.count; ++k)
            if (meet(a.elementBounds[i], b.elementBounds[k]) && !(pieces && (isFragment(a, i) || isFragment(b, k))))
                pairs.push_back({i, k});
}

} // namespace

void collectElementPairs(const CollisionSurface& a, const CollisionSurface& b, ProximityScratch& scratch)
{
    const bool self = &a == &b;
    scratch.elementPairs.clear();
    scratch.open.clear();
    scratch.open.push_back({0, 0});
    while (!scratch.open.empty()) {
        const auto [i, k] = scratch.open.back();
        scratch.open.pop_back();
        if (!meet(a.nodeBounds[i], b.nodeBounds[k])) continue;
        const CollisionShape::Node &na = a.shape->nodes[i], &nb = b.shape->nodes[k];
        if (na.count > 0 && nb.count > 0) {
            collectLeafPairs(a, b, na, nb, scratch.elementPairs);
        } else if (self && i == k) {
            scratch.open.push_back({i + 1, na.first});
            scratch.open.push_back({na.first, na.first});
            scratch.open.push_back({i + 1, i + 1});
        } else if (nb.count > 0 || (na.count == 0 && widthOf(a.nodeBounds[i]) >= widthOf(b.nodeBounds[k]))) {
            scratch.open.push_back({na.first, k});
            scratch.open.push_back({i + 1, k});
        } else {
            scratch.open.push_back({i, nb.first});
            scratch.open.push_back({i, k + 1});
        }
    }
}

} // namespace filasofia::engine
