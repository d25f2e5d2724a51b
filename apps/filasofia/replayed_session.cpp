#include "apps/filasofia/report.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/sampling.h"
#include "filasofia/record/session_player.h"
#include "filasofia/runtime/engines.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <set>

// The only place where a report depends on the format of recordings.
namespace filasofia::app {
namespace {

const std::string& nameOf(const physics::AddBody& body)
{
    return std::visit([](const auto& def) -> const std::string& { return def.name; }, *body.def);
}

/// The rigid bodies of a list, in the same order.
std::vector<const physics::AddBody*> rigidOf(const std::vector<physics::AddBody>& bodies)
{
    std::vector<const physics::AddBody*> rigid;
    for (const physics::AddBody& body : bodies)
        if (std::holds_alternative<physics::RigidBodyDef>(*body.def)) rigid.push_back(&body);
    return rigid;
}

/// The body that is measured. `moved`: the bodies moved from outside.
BodyId toolOf(const std::vector<const physics::AddBody*>& rigid, const std::set<BodyId>& moved, const std::string& name,
              const std::string& file)
{
    std::string list;
    for (const physics::AddBody* body : rigid) {
        if (name.empty() ? moved.contains(body->id) : nameOf(*body) == name) return body->id;
        list += text(list.empty() ? "" : ", ", "'", shortened(nameOf(*body)), "'");
    }
    if (rigid.empty()) fail(file, ": the recording has no rigid body, so a hand cannot have moved anything");
    if (name.empty()) fail(file, ": no rigid body is moved from outside; choose one with --tool: ", list);
    fail(file, ": the recording has no rigid body '", shortened(name), "'; it has ", list);
}

constexpr double kReplayRate = 200.0; // [Hz] rate of the samples

} // namespace

metric::Session replayedSession(const std::filesystem::path& recording, const std::string& tool, int threads)
{
    record::SessionPlayer player(recording, [&](const record::RecordingHeader& header) {
        return runtime::makeReplayEngine(header, recording.string(),
                                         threads == 0 ? std::nullopt : std::optional(threads));
    });
    const record::RecordingHeader& header = player.header();
    metric::Session session{.trainee = header.trainee,
                            .task = header.session,
                            .date = header.date,
                            .software = header.filasofia,
                            .seed = header.seed,
                            .watched = {metric::EventKind::Tear, metric::EventKind::Cut}};
    std::set<BodyId> moved; // bodies moved from outside
    std::map<BodyId, metric::StepSampler> samplers;
    std::map<BodyId, std::vector<metric::Sample>> samples;
    double lastPeriod = -1.0;
    bool same = true;
    while (player.next()) {
        for (const physics::Command& command : player.recorded().commands)
            if (const auto* pose = std::get_if<physics::SetPose>(&command)) moved.insert(pose->id);
        const physics::StepReport& report = player.report();
        if (same && !player.same()) {
            same = false;
            std::cerr << oneLine(recording.string()) << ": the replay differs from the recording from step "
                      << report.step << " on (filasofia replay --check gives details)\n";
        }
        for (const physics::Rupture& rupture : report.topology.ruptures)
            session.events.push_back(
                {report.time,
                 rupture.kind == physics::Rupture::Kind::Tear ? metric::EventKind::Tear : metric::EventKind::Cut,
                 nameOf(*std::ranges::lower_bound(player.bodies(), rupture.body, {}, &physics::AddBody::id)),
                 rupture.area});
        if (report.dt == 0.0) continue; // paused
        const frame::Frame& frame = player.frame();
        for (const physics::AddBody* body : rigidOf(player.bodies()))
            samplers.try_emplace(body->id, metric::Observed{.body = body->id}).first->second.add(frame, report.dt);
        const double period = std::floor(report.time * kReplayRate + 1e-6);
        if (period <= lastPeriod) continue;
        lastPeriod = period;
        for (auto& [id, sampler] : samplers) samples[id].push_back(sampler.take());
    }
    session.complete = player.damage().empty();
    const std::vector<const physics::AddBody*> rigid = rigidOf(player.bodies());
    if (rigid.empty() && !session.complete) fail(player.damage());
    if (!session.complete) std::cerr << oneLine(player.damage()) << '\n';
    const BodyId measured = toolOf(rigid, moved, tool, recording.string());
    // Bodies moved by a hand are instruments; the measured one comes first.
    for (const physics::AddBody* body : rigid) {
        const bool instrument = body->id == measured || moved.contains(body->id);
        session.tracks.insert(body->id == measured ? session.tracks.begin() : session.tracks.end(),
                              {.name = nameOf(*body),
                               .role = instrument ? metric::Role::Tool : metric::Role::Other,
                               .samples = std::move(samples[body->id])});
    }
    return session;
}

} // namespace filasofia::app
