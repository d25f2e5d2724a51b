#include "filasofia/runtime/nothing_watch.h"

#include "filasofia/core/text.h"
#include "filasofia/runtime/contact_watch.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

constexpr std::size_t kMostLines = 12;

/// The attachment as it is known: by its place in its body's Def, else by its number.
std::string attachmentOf(const physics::NothingHeld& nothing, const physics::PhysicsServer& physics)
{
    if (physics.has(nothing.body)) {
        const std::vector<AttachmentId> own = physics.attachments(nothing.body);
        if (const auto found = std::ranges::find(own, nothing.id); found != own.end())
            return text("attachments[", found - own.begin(), "]");
    }
    return text("attachment ", nothing.id.value);
}

std::string lineOf(const physics::NothingHeld& nothing, const physics::PhysicsServer& physics)
{
    const std::string body = text("'", nameOf(nothing.body, physics), "': ");
    if (nothing.grasp)
        return text(body, "grasp of '", nameOf(nothing.to, physics), "' holds nothing: they did not touch");
    const std::string to = nothing.to ? text(" to '", nameOf(nothing.to, physics), "'") : std::string();
    return text(body, attachmentOf(nothing, physics), to, " holds nothing: no node was there");
}

} // namespace

void NothingWatch::count(const physics::StepReport& report)
{
    for (const physics::NothingHeld& each : report.nothingHeld)
        if (++all_ <= kMostLines) first_.push_back(each);
}

std::vector<std::string> NothingWatch::lines(const physics::PhysicsServer& physics) const
{
    std::vector<std::string> out;
    for (const physics::NothingHeld& each : first_) out.push_back(lineOf(each, physics));
    if (all_ > first_.size()) out.push_back(text("and ", all_ - first_.size(), " more that hold nothing"));
    return out;
}

} // namespace filasofia::runtime
