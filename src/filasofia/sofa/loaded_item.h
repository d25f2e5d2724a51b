#pragma once

#include "filasofia/sofa/sofa_vec.h"

#include "filasofia/physics/defs.h"

#include <sofa/core/State.h>

namespace filasofia::sofaengine {

/// An object of a loaded graph, as a body of ours.
struct LoadedItem {
    std::string name = {};
    physics::BodyDef def = {}; ///< what it is at the start, for whoever shows it; SOFA moves it
    bool picture = false;
    std::vector<int> vertices = {}; ///< the state's node of each vertex of the body; empty: they are the nodes
    ::sofa::core::State<Vec3Types>* soft = nullptr;
    ::sofa::core::State<RigidTypes>* rigid = nullptr;
};
/// Makes the body of a state whose name the item has; false if it has no elements that a body may have. `unit` [m] is
/// the scene's unit of length.
bool makeItem(::sofa::core::BaseState& state, double unit, LoadedItem& item);

/// The elements over a state as SOFA has them now, by its nodes.
struct ItemElements {
    std::vector<geometry::Tetrahedron> tetrahedra = {}; ///< those of a hexahedron are six
    std::vector<geometry::Triangle> triangles = {};     ///< without volumes; those of a quad are two
    friend bool operator==(const ItemElements&, const ItemElements&) = default;
};
/// `nodes`: for the orientation of tetrahedra. Elements of nodes that do not exist are left out.
ItemElements elementsOf(::sofa::core::State<Vec3Types>& state, const std::vector<Vec3>& nodes);

/// [m] Where the nodes are, or where they are at rest: as they are now if the state has no rest.
std::vector<Vec3> placesOf(const ::sofa::core::State<Vec3Types>& state, double unit);
std::vector<Vec3> restOf(const ::sofa::core::State<Vec3Types>& state, double unit);

/// The triangles that a surface may have: each once, and none that is flat.
std::vector<geometry::Triangle> tidied(const std::vector<geometry::Triangle>& triangles, const std::vector<Vec3>& at);

} // namespace filasofia::sofaengine
