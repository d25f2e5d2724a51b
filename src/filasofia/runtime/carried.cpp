#include "filasofia/runtime/carried.h"

#include "filasofia/core/error.h"

#include <cmath>

namespace filasofia::runtime {
namespace {

using surface::BloodCommand;

template <class Command> std::optional<Command> inTheWorld(Command command, const frame::Frame& frame)
{
    const std::optional<Vec3> place = placeNow(command, frame);
    if (!place) return std::nullopt;
    command.place = *place;
    command.body = {};
    return command;
}

/// A command replaces the one before, carried or not.
template <class Command> void begin(Command command, std::optional<Command>& carried, std::vector<BloodCommand>& out)
{
    carried.reset();
    if (command.body && command.rate > 0.0) {
        carried = command;
        return;
    }
    command.body = {};
    out.emplace_back(command);
}

/// Gives a command where its body carries it now, or its end.
template <class Command>
void goOn(std::optional<Command>& carried, const frame::Frame& frame, std::vector<BloodCommand>& out)
{
    if (!carried) return;
    const std::optional<Command> now = inTheWorld(*carried, frame);
    out.emplace_back(now.value_or(Command{.rate = 0.0}));
    if (!now) carried.reset();
}

} // namespace

void checkCarrier(BodyId body, int element, const physics::PhysicsServer& physics, const std::string& object)
{
    if (!body) return;
    const auto def = physics.def(body);
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&*def);
    if (rigid == nullptr) fail(object, ": body must be a rigid one, got ", physics::describeBody(*def));
    if (const auto count = static_cast<int>(physics::elementCount(*rigid)); element >= count)
        fail(object, ": element must be in [0, ", count, "), got ", element);
}

void CarriedTreatments::follow(const frame::Frame& frame, std::vector<BloodCommand>& commands)
{
    std::vector<BloodCommand> out;
    for (const BloodCommand& each : commands) {
        if (const auto* suck = std::get_if<surface::Suck>(&each))
            begin(*suck, suck_, out);
        else if (const auto* rinse = std::get_if<surface::Rinse>(&each); rinse && std::isfinite(rinse->rate))
            begin(*rinse, rinse_, out);
        else if (rinse && rinse->body) {
            if (const auto now = inTheWorld(*rinse, frame)) out.emplace_back(*now);
        } else
            out.push_back(each);
    }
    goOn(suck_, frame, out);
    goOn(rinse_, frame, out);
    commands = std::move(out);
}

} // namespace filasofia::runtime
