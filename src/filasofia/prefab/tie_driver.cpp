#include "filasofia/prefab/tie_driver.h"

#include <algorithm>
#include <cmath>

namespace filasofia::prefab {
namespace {

constexpr double kWound = 3.6e-3; ///< [m] from its axis: what is nearer is wound around it
constexpr double kArm = 0.1;      ///< [m] at which its turning counts as a way

} // namespace

void TieDriver::move(const Pose& to)
{
    pose = to;
    instrument.move(pose);
}

bool TieDriver::go(const Pose& to, double most)
{
    const double left = std::max(distance(pose.position, to.position),
                                 kArm * length(rotationVector(conjugate(pose.orientation) * to.orientation)));
    move(left > most ? between(pose, to, most / left) : to);
    return left <= most;
}

Vec3 TieDriver::holdsAt() const { return transform(pose, {0.0, 0.0, -mouth}); }

Pose TieDriver::back(double by) const
{
    return {pose.position + by * rotate(pose.orientation, {0.0, 0.0, 1.0}), pose.orientation};
}

bool TieDriver::isWound(Vec3 at) const
{
    const Vec3 from = transform(inverse(pose), at);
    return std::hypot(from.x, from.y) < kWound && from.z > -mouth - kWound;
}

AttachmentId TieDriver::gripOn(BodyId body, const frame::Frame& now) const
{
    const auto found = std::ranges::find_if(now.attachments, [&](const frame::Attachment& each) {
        return each.body == body && each.to == instrument.body();
    });
    return found != now.attachments.end() ? found->id : AttachmentId{};
}

} // namespace filasofia::prefab
