#pragma once

#include "filasofia/sofa/loaded_item.h"

#include "filasofia/frame/frame.h"

#include <array>
#include <map>
#include <set>

namespace filasofia::sofaengine {

/// A body of a loaded scene as frames show it. A scene may cut its meshes: SOFA then moves its last nodes into the
/// places of those that it removes. Here a node keeps its number, one that is gone stays where it was, and new ones
/// follow; only those of pictures, which have no rest by which they could be known again, are numbered anew.
class ItemView {
public:
    /// `cut`: frames have its boundary from the start, because they had another one before.
    ItemView(LoadedItem item, double unit, bool cut = false);

    [[nodiscard]] const LoadedItem& item() const { return item_; }
    [[nodiscard]] const ItemElements& elements() const { return elements_; }
    [[nodiscard]] int nodeCount() const; ///< or elements
    [[nodiscard]] bool isCut() const { return revision_ > 0; }
    /// Reads SOFA's state, whose numbers are usable.
    void look();
    void write(BodyId id, frame::SoftBodyFrame& out) const;
    [[nodiscard]] const frame::RigidBodyFrame& rigid() const { return rigid_; } ///< without its id

private:
    using Key = std::array<double, 3>;
    void lookAtRigid();
    void follow(ItemElements now);
    void renumber(const std::vector<Vec3>& rest);
    void writeBoundary(const std::vector<Vec3>& rest);
    int nodeAt(int source, const std::vector<Vec3>& rest);
    geometry::Triangle skinKey(const geometry::Triangle& nodes) const;

    LoadedItem item_;
    double unit_;                       ///< [m]
    ItemElements elements_;             ///< by SOFA's nodes
    std::vector<int> sources_;          ///< SOFA's node of each node; -1: gone
    std::vector<int> numbers_;          ///< the node of each of SOFA's; -1: none
    std::vector<Vec3> sofaRest_;        ///< [m] per node of SOFA, at rest
    std::vector<Vec3> rest_, places_;   ///< [m] per node
    std::vector<Vec3> speeds_;          ///< [m/s] per node
    std::map<Key, int> firsts_;         ///< the first node with this place at rest
    std::set<geometry::Triangle> skin_; ///< faces that were outside at the start, by the first nodes there
    std::shared_ptr<const frame::Boundary> boundary_;
    std::uint64_t revision_ = 0;
    frame::RigidBodyFrame rigid_;
};

} // namespace filasofia::sofaengine
