#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/surface/bleeding_def.h"

#include <optional>
#include <string>
#include <vector>

/// Places that an element of a rigid body carries: openings of suction, nozzles.
namespace filasofia::runtime {

/// Throws an Error that begins with `object` if the body is no rigid one, or has no such element.
void checkCarrier(BodyId body, int element, const physics::PhysicsServer& physics, const std::string& object);

/// [m], in the world; nothing if the body that carries it is gone.
template <class Command> std::optional<Vec3> placeNow(const Command& command, const frame::Frame& frame)
{
    if (!command.body) return command.place;
    const frame::RigidBodyFrame* body = frame.rigidBody(command.body);
    if (body == nullptr || command.element >= std::ssize(body->poses)) return std::nullopt;
    return transform(body->poses[static_cast<std::size_t>(command.element)], command.place);
}

/// The suction and the rinsing of one body's blood that rigid bodies carry.
class CarriedTreatments {
public:
    /// Takes the commands that came since the last step of the blood, and leaves those for the next one: with places in
    /// the world, and with what is carried. What its body no longer carries ends.
    void follow(const frame::Frame& frame, std::vector<surface::BloodCommand>& commands);

private:
    std::optional<surface::Suck> suck_;
    std::optional<surface::Rinse> rinse_;
};

} // namespace filasofia::runtime
