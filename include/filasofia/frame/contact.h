#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::frame {

/// A contact between two bodies, or between two parts of one body: its geometry at the start of the step and the forces
/// during it.
struct Contact {
    BodyId first = {};
    BodyId second = {};
    Vec3 point = {};          ///< [m] between the two surfaces
    Vec3 normal = {};         ///< unit, from the second body towards the first
    double gap = 0.0;         ///< [m] between the surfaces; negative if they overlap
    double normalForce = 0.0; ///< [N] on the first body along the normal; the second body gets the opposite
    Vec3 friction = {};       ///< [N] on the first body across the normal; the second body gets the opposite
};

/// [N] The force of a contact on `body`, one of its two bodies. For a contact of a body with itself, the force on its
/// first side.
inline Vec3 forceOn(BodyId body, const Contact& contact)
{
    const Vec3 onFirst = contact.normalForce * contact.normal + contact.friction;
    return contact.first == body ? onFirst : -onFirst;
}
/// [N] The total force of a body's contacts with other bodies.
Vec3 forceOn(BodyId body, const std::vector<Contact>& contacts);

/// The contact forces between two bodies, summed over their contacts.
struct ContactPair {
    BodyId first = {};
    BodyId second = {};
    int contacts = 0;           ///< number of contacts with a normal force
    Vec3 force = {};            ///< [N] normal force and friction on the first body; the second body gets the opposite
    double normalForce = 0.0;   ///< [N] the sum of the contacts' normal forces
    double frictionForce = 0.0; ///< [N] the sum of the contacts' friction magnitudes
};

/// The sums over contacts, sorted by bodies; a pair of bodies that are near each other without a force has zeros.
std::vector<ContactPair> contactPairs(const std::vector<Contact>& contacts);

} // namespace filasofia::frame
