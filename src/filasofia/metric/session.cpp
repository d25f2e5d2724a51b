#include "filasofia/metric/session.h"

#include <array>

namespace filasofia::metric {
namespace {

struct KindName {
    EventKind kind;
    std::string_view name;
};
constexpr std::array kKinds = {
    KindName{EventKind::Grasp, "grasp"},
    KindName{EventKind::Release, "release"},
    KindName{EventKind::Tear, "tear"},
    KindName{EventKind::Cut, "cut"},
    KindName{EventKind::Perforation, "perforation"},
    KindName{EventKind::Blood, "blood"},
    KindName{EventKind::Energy, "energy"},
    KindName{EventKind::Activation, "activation"},
    KindName{EventKind::InAir, "in_air"},
    KindName{EventKind::Leak, "leak"},
    KindName{EventKind::Deficit, "deficit"},
    KindName{EventKind::Clip, "clip"},
    KindName{EventKind::ClipLost, "clip_lost"},
    KindName{EventKind::ClipSlipped, "clip_slipped"},
    KindName{EventKind::Burn, "burn"},
    KindName{EventKind::Removed, "removed"},
    KindName{EventKind::Seen, "seen"},
    KindName{EventKind::Residual, "residual"},
    KindName{EventKind::Step, "step"},
    KindName{EventKind::Mistake, "mistake"},
    KindName{EventKind::Unfinished, "unfinished"},
    KindName{EventKind::Note, "note"},
};

} // namespace

void takeBack(Session& session, double time)
{
    const auto later = [time](const auto& each) { return each.time > time; };
    for (Track& track : session.tracks) std::erase_if(track.samples, later);
    std::erase_if(session.events, later);
}

std::string_view name(Role role) { return names(&role)[static_cast<std::size_t>(role)]; }

std::string_view name(EventKind kind)
{
    for (const KindName& each : kKinds)
        if (each.kind == kind) return each.name;
    return "note";
}

std::optional<EventKind> eventKind(std::string_view name)
{
    for (const KindName& each : kKinds)
        if (each.name == name) return each.kind;
    return std::nullopt;
}

const Event* findUnfinished(const Session& session)
{
    const Event* last = nullptr;
    for (const Event& event : session.events)
        if (event.kind == EventKind::Unfinished)
            last = &event;
        else if (event.kind == EventKind::Step)
            last = nullptr;
    return last;
}

const Track* findTrack(const Session& session, Role role, int skip)
{
    for (const Track& track : session.tracks)
        if (track.role == role && skip-- == 0) return &track;
    return nullptr;
}

} // namespace filasofia::metric
