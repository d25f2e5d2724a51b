#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::frame {

/// A place where two bodies, or two parts of one, are near each other, at the start of the step; what they do to each
/// other during it.
struct Contact {
    BodyId first = {};
    BodyId second = {};
    Vec3 point = {};          ///< [m] between the two surfaces
    Vec3 normal = {};         ///< unit, from the second body towards the first
    double gap = 0.0;         ///< [m] between the surfaces; negative: they are inside each other
    double normalForce = 0.0; ///< [N] on the first body along the normal, on the second against it
    Vec3 friction = {};       ///< [N] on the first body across the normal, on the second the opposite
};

/// [N] By which a contact pushes `body`, one of its two. Of a contact with itself: its first side.
inline Vec3 forceOn(BodyId body, const Contact& contact)
{
    const Vec3 onFirst = contact.normalForce * contact.normal + contact.friction;
    return contact.first == body ? onFirst : -onFirst;
}
/// [N] By which all its contacts with others push `body`.
Vec3 forceOn(BodyId body, const std::vector<Contact>& contacts);

/// What two bodies do to each other by all their contacts.
struct ContactPair {
    BodyId first = {};
    BodyId second = {};
    int contacts = 0;           ///< that push
    Vec3 force = {};            ///< [N] on the first body, normal and friction; on the second the opposite
    double normalForce = 0.0;   ///< [N] the sum of the contacts' normal forces
    double frictionForce = 0.0; ///< [N] the sum of the sizes of their frictions
};

/// The sums over contacts, ascending by bodies; pairs that are near but do not push are there with zeros.
std::vector<ContactPair> contactPairs(const std::vector<Contact>& contacts);

} // namespace filasofia::frame
