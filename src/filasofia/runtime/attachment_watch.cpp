#include "filasofia/runtime/attachment_watch.h"

#include "filasofia/core/text.h"
#include "filasofia/runtime/contact_watch.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

constexpr std::size_t kMostLines = 12;

/// Three digits after the point: times to a millisecond, forces to a millinewton.
double thousandths(double value) { return std::round(1e3 * value) / 1e3; }

/// The attachment as it is known: by its place in its body's Def, else by its number.
std::string attachmentOf(AttachmentId id, BodyId body, const physics::PhysicsServer& physics)
{
    if (physics.has(body)) {
        const std::vector<AttachmentId> own = physics.attachments(body);
        if (const auto found = std::ranges::find(own, id); found != own.end())
            return text("attachments[", found - own.begin(), "]");
    }
    return text("attachment ", id.value);
}

/// "'liver': attachments[1] to 'wall'"
std::string placeOf(AttachmentId id, BodyId body, BodyId to, const physics::PhysicsServer& physics)
{
    const std::string other = to ? text(" to '", nameOf(to, physics), "'") : std::string();
    return text("'", nameOf(body, physics), "': ", attachmentOf(id, body, physics), other);
}

std::string lineOf(const physics::NothingHeld& nothing, const physics::PhysicsServer& physics)
{
    if (nothing.grasp)
        return text("'", nameOf(nothing.body, physics), "': grasp of '", nameOf(nothing.to, physics),
                    "' holds nothing: they did not touch");
    return placeOf(nothing.id, nothing.body, nothing.to, physics) + " holds nothing: no node was there";
}

} // namespace

void AttachmentWatch::count(const physics::StepReport& report)
{
    for (const physics::NothingHeld& each : report.nothingHeld)
        if (++allNothing_ <= kMostLines) nothing_.push_back(each);
    for (const physics::AttachmentBreak& each : report.breaks) {
        auto known = std::ranges::find(broke_, each.id, [](const Break& other) { return other.all.id; });
        if (known == broke_.end()) {
            broke_.push_back({.all = each, .first = report.time, .last = report.time});
            continue;
        }
        known->all.points += each.points;
        known->all.force = std::max(known->all.force, each.force);
        known->all.broken = known->all.broken || each.broken;
        known->last = report.time;
    }
}

std::vector<std::string> AttachmentWatch::nothing(const physics::PhysicsServer& physics) const
{
    std::vector<std::string> out;
    for (const physics::NothingHeld& each : nothing_) out.push_back(lineOf(each, physics));
    if (allNothing_ > nothing_.size())
        out.push_back(text("and ", allNothing_ - nothing_.size(), " more that hold nothing"));
    return out;
}

std::vector<std::string> AttachmentWatch::broke(const physics::PhysicsServer& physics) const
{
    std::vector<std::string> out;
    for (const Break& each : broke_) {
        const physics::AttachmentBreak& all = each.all;
        if (out.size() == kMostLines) {
            out.push_back(text("and ", broke_.size() - kMostLines, " more of which points let go"));
            break;
        }
        const std::string name =
            all.grasp ? text("'", nameOf(all.to, physics), "': grasp of '", nameOf(all.body, physics), "'")
                      : placeOf(all.id, all.body, all.to, physics);
        const std::string until = each.last > each.first ? text(" to ", thousandths(each.last), " s") : " s";
        out.push_back(all.broken
                          ? text(name, " broke at ", thousandths(each.last), " s (", thousandths(all.force), " N)")
                          : text(name, ": ", all.points, all.points == 1 ? " point" : " points", " let go at ",
                                 thousandths(each.first), until, " (at most ", thousandths(all.force), " N)"));
    }
    return out;
}

} // namespace filasofia::runtime
