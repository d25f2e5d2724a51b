#include "apps/filasofia/report.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/metric/sampling.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/session_player.h"

#include <cmath>
#include <iostream>
#include <map>
#include <set>

// The one place where a report meets the format of recordings.
namespace filasofia::app {
namespace {

/// The bodies of a recording, which are rigid and which of them were moved from outside, as its commands tell.
struct Bodies {
    std::map<BodyId, std::string> names = {};
    std::vector<BodyId> rigid = {};
    std::set<BodyId> moved = {};

    void hear(const physics::Command& command)
    {
        if (const auto* added = std::get_if<physics::AddBody>(&command)) {
            names[added->id] = std::visit([](const auto& def) { return def.name; }, *added->def);
            if (std::holds_alternative<physics::RigidBodyDef>(*added->def)) rigid.push_back(added->id);
        } else if (const auto* pose = std::get_if<physics::SetPose>(&command)) {
            moved.insert(pose->id);
        }
    }

    /// The one that is measured.
    [[nodiscard]] BodyId tool(const std::string& name, const std::string& file) const
    {
        std::string list;
        for (const BodyId id : rigid) {
            if (name.empty() ? moved.contains(id) : names.at(id) == name) return id;
            list += text(list.empty() ? "" : ", ", "'", shortened(names.at(id)), "'");
        }
        if (rigid.empty()) fail(file, ": has no rigid body, so nothing that a hand could have moved");
        if (name.empty()) fail(file, ": no rigid body is moved from outside; --tool names one of ", list);
        fail(file, ": there is no rigid body '", shortened(name), "'; there are ", list);
    }
};

constexpr double kRate = 200.0; // [Hz], of samples

} // namespace

metric::Session replayedSession(const std::filesystem::path& recording, const std::string& tool, int threads)
{
    record::SessionPlayer player(recording, [&](const record::RecordingHeader& header) {
        return engine::makeNativeEngine({.period = header.period,
                                         .threads = threads == 0 ? std::nullopt : std::optional(threads),
                                         .contact = header.contact});
    });
    const record::RecordingHeader& header = player.header();
    metric::Session session{.trainee = header.trainee,
                            .task = header.session,
                            .date = header.date,
                            .software = header.filasofia,
                            .seed = header.seed,
                            .watched = {metric::EventKind::Tear, metric::EventKind::Cut}};
    Bodies bodies;
    std::map<BodyId, metric::StepSampler> samplers;
    std::map<BodyId, std::vector<metric::Sample>> samples;
    double lastPeriod = -1.0;
    bool same = true;
    while (player.next()) {
        for (const physics::Command& command : player.recorded().commands) bodies.hear(command);
        const physics::StepReport& report = player.report();
        if (same && !player.same()) {
            same = false;
            std::cerr << oneLine(recording.string()) << ": made again it differs from step " << report.step
                      << " on (filasofia replay --check says more)\n";
        }
        for (const physics::Rupture& rupture : report.topology.ruptures)
            session.events.push_back(
                {report.time,
                 rupture.kind == physics::Rupture::Kind::Tear ? metric::EventKind::Tear : metric::EventKind::Cut,
                 bodies.names[rupture.body], rupture.area});
        if (report.dt == 0.0) continue; // paused
        const frame::Frame& frame = player.frame();
        for (const BodyId id : bodies.rigid)
            samplers.try_emplace(id, metric::Observed{.body = id}).first->second.add(frame, report.dt);
        const double period = std::floor(report.time * kRate + 1e-6);
        if (period <= lastPeriod) continue;
        lastPeriod = period;
        for (auto& [id, sampler] : samplers) samples[id].push_back(sampler.take());
    }
    session.complete = player.damage().empty();
    if (bodies.rigid.empty() && !session.complete) fail(player.damage());
    if (!session.complete) std::cerr << oneLine(player.damage()) << '\n';
    const BodyId measured = bodies.tool(tool, recording.string());
    for (const BodyId id : bodies.rigid)
        session.tracks.push_back({.name = bodies.names[id],
                                  .role = id == measured ? metric::Role::Tool : metric::Role::Other,
                                  .samples = std::move(samples[id])});
    return session;
}

} // namespace filasofia::app
