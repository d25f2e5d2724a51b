#pragma once

#include "filasofia/frame/contact.h"
#include "filasofia/physics/step.h"

#include <vector>

namespace filasofia::physics {

/// Adds a contact's normal force to the intersection of its two bodies, if there is one.
inline void addForce(const frame::Contact& contact, std::vector<Intersection>& intersections)
{
    for (Intersection& each : intersections)
        if ((each.first == contact.first && each.second == contact.second) ||
            (each.first == contact.second && each.second == contact.first))
            each.force += contact.normalForce;
}

} // namespace filasofia::physics
