#include "filasofia/prefab/hand_step.h"

#include <cmath>

namespace filasofia::prefab {

double HandStep::draw(StrandHand& hand, Vec3 origin, double force) const
{
    const double by = drawnBy(force - hand.tension(now), stiffness, speed * dt);
    hand.moveBy(by);
    simulation.physics().setPose(hand.body, Pose{hand.at(origin)});
    return std::abs(by);
}

bool HandStep::turn(StrandHand& hand, Vec3 to, double force) const
{
    hand.direction = turnedTowards(hand.direction, to, speed * dt / hand.away);
    const bool moves = draw(hand, place, force) > kCreep * dt;
    return distance(hand.direction, to) < 1e-6 && !moves;
}

bool HandStep::goTo(StrandHand& hand, Vec3 to) const
{
    const Vec3 at = hand.at(place);
    const double left = distance(at, to), most = speed * dt;
    put(hand, left > most ? at + most / left * (to - at) : to);
    return left <= most;
}

void HandStep::put(StrandHand& hand, Vec3 at) const
{
    hand.place(at, place, up);
    simulation.physics().setPose(hand.body, Pose{hand.at(place)});
}

} // namespace filasofia::prefab
