#include "filasofia/prefab/tie_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::prefab {
namespace {

constexpr double kTilt = 20.0 * std::numbers::pi / 180.0; ///< [rad] by which the driver points down
constexpr double kRise = 20.0 * std::numbers::pi / 180.0; ///< [rad] by which the tail rises while the hand winds
constexpr double kTaut = 0.95;                            ///< [-] from its base to its end, if the tail's length is 1
/// [m] from the loops to where the jaws hold the tail: the jaws taper, the shaft does not.
constexpr double kAhead = 14e-3;
constexpr double kLean = 0.12;    ///< [-] along the shaft, for each length of the strand
constexpr double kComing = 60e-3; ///< [m] that the driver comes along its shaft
constexpr double kTurning = 0.11; ///< [m] over the place, where it turns to the other side
constexpr double kOut = 10e-3;    ///< [m] from the loops back to the mouth once they are off
constexpr double kLow = 5e-3;     ///< [m] least height over the tail's base in which the jaws take it

} // namespace

Vec3 TiePlan::direction(double toStrand, double upwards, double forwards) const
{
    return normalized(toStrand * side * across + upwards * up + forwards * front);
}
Vec3 TiePlan::along() const { return direction(-std::cos(kTilt), -std::sin(kTilt), 0.0); }
Vec3 TiePlan::over() const { return direction(-std::sin(kTilt), std::cos(kTilt), 0.0); }
Vec3 TiePlan::aside() const { return tailBase - kTaut * tail * tailwards(); }
Vec3 TiePlan::tailwards() const { return direction(std::cos(kRise), -std::sin(kRise), 0.0); }
/// To the tip and down: the loops then slide off the jaws over the tail. Where it bowed aside, and so lay in the jaws
/// towards the shaft, it hooked a loop, and the driver drew in vain.
Vec3 TiePlan::inwards() const { return normalized(along() - over()); }
/// So low that the tail suffices for the way up to the loops, which fingers hold, and through them back to the mouth;
/// taken higher it would be stretched.
Vec3 TiePlan::shown() const
{
    const double ahead = kAhead - between(), all = kTaut * tail, toLoops = std::max(all - kOut, 0.0);
    const double squared = std::min(toLoops * toLoops - between() * between(), all * all - ahead * ahead);
    return tailBase + ahead * along() + std::sqrt(std::max(squared, kLow * kLow)) * over();
}
double TiePlan::between() const { return dot(tailBase - strandBase, along()); }
double TiePlan::leastTail() const { return (std::hypot(between(), kLow) + kOut) / kTaut; }
/// Then there is as much strand for the loops and the hand as for the way to them: the hand passes below the shaft, and
/// above the tissue.
double TiePlan::high() const { return 0.5 * strand; }
Vec3 TiePlan::loops(const Pose& driver) const
{
    return driver.position + dot(strandBase - driver.position, along()) * along();
}
/// Below the shaft the strand leans to its tip, and passes its own base on that side. If it passes on the other one,
/// the strands wind around each other all the same, but what comes of it is no knot.
Vec3 TiePlan::around(double angle) const
{
    return normalized(std::cos(angle) * front + std::sin(angle) * over() - kLean * std::sin(angle) * along());
}

Pose TiePlan::holding(Vec3 at) const
{
    const Vec3 to = along();
    return {at - mouth * to, toQuat(Mat3::columns(cross(to, front), front, -to))};
}
Pose TiePlan::above(Vec3 place) const
{
    return {place + kTurning * up, toQuat(Mat3::columns(cross(-up, front), front, up))};
}
Pose TiePlan::coming() const
{
    const Pose to = winding();
    return {to.position - kComing * along(), to.orientation};
}
Pose TiePlan::winding() const { return holding(strandBase + high() * over() + kAhead * along()); }
Pose TiePlan::drawn() const { return holding(shown() - (kAhead + kOut) * along()); }

} // namespace filasofia::prefab
