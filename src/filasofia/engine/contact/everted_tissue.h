#pragma once

#include "filasofia/engine/contact/contact_surfaces.h"

namespace filasofia::engine {

/// Whether a place lies on an inverted element of a soft body. There the surface faces the wrong way, and a contact
/// would keep it inverted.
bool onInvertedElement(const SurfaceOwner& owner, const Proximity& found, std::size_t side, const Scene& scene);

/// At an inverted element the surface of tissue does not tell which way is out, and a contact by it would keep the
/// element inverted. If the other side is rigid and closed, that one tells it: always for a point of tissue at its face
/// or edge, and else while they come nearer fast. Returns whether the contact stays, turned round if need be. When a
/// step had no contacts at such places, a kilogram that had crushed a liver at 2.6 m/s passed through it.
bool staysAtInverted(const SurfaceOwner& other, const std::vector<CollisionSurface>& surfaces, double dt,
                     std::size_t side, Proximity& found);

} // namespace filasofia::engine
