#include "apps/filasofia/report.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/metric/sampling.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

// The one place where a report meets the format of recordings.
namespace filasofia::app {
namespace {

/// The rigid bodies of a recording and which of them were moved from outside, as its commands tell.
struct Bodies {
    struct Body {
        BodyId id;
        std::string name;
    };
    std::vector<Body> rigid = {};
    std::set<BodyId> moved = {};

    void hear(const physics::Command& command)
    {
        if (const auto* added = std::get_if<physics::AddBody>(&command)) {
            if (const auto* def = std::get_if<physics::RigidBodyDef>(added->def.get()))
                rigid.push_back({added->id, def->name});
        } else if (const auto* pose = std::get_if<physics::SetPose>(&command)) {
            moved.insert(pose->id);
        }
    }

    /// The one that is measured.
    [[nodiscard]] BodyId tool(const std::string& name, const std::string& file) const
    {
        std::string names;
        for (const Body& body : rigid) {
            if (name.empty() ? moved.contains(body.id) : body.name == name) return body.id;
            names += text(names.empty() ? "" : ", ", "'", shortened(body.name), "'");
        }
        if (rigid.empty()) fail(file, ": has no rigid body, so nothing that a hand could have moved");
        if (name.empty()) fail(file, ": no rigid body is moved from outside; --tool names one of ", names);
        fail(file, ": there is no rigid body '", shortened(name), "'; there are ", names);
    }
};

constexpr double kRate = 200.0; // [Hz], of samples

} // namespace

metric::Session replayedSession(const std::filesystem::path& recording, const std::string& tool, int threads)
{
    record::RecordingReader reader(recording);
    const auto engine = engine::makeNativeEngine({.period = reader.header().period,
                                                  .threads = threads == 0 ? std::nullopt : std::optional(threads),
                                                  .contact = reader.header().contact});
    record::Replayer replayer(*engine);

    Bodies bodies;
    std::map<BodyId, std::vector<metric::Sample>> samples;
    metric::Session session{.software = reader.header().filasofia,
                            .watched = {metric::EventKind::Tear, metric::EventKind::Cut}};
    std::map<BodyId, std::string> names;
    frame::Frame frame;
    double lastPeriod = -1.0;
    while (const auto step = reader.next()) {
        for (const physics::Command& command : step->commands) {
            bodies.hear(command);
            if (const auto* added = std::get_if<physics::AddBody>(&command))
                names[added->id] = std::visit([](const auto& def) { return def.name; }, *added->def);
        }
        const physics::StepReport report = replayer.step(*step);
        for (const physics::Rupture& rupture : report.topology.ruptures)
            session.events.push_back(
                {report.time,
                 rupture.kind == physics::Rupture::Kind::Tear ? metric::EventKind::Tear : metric::EventKind::Cut,
                 names[rupture.body], rupture.area});
        const double period = std::floor(report.time * kRate + 1e-6);
        if (report.dt == 0.0 || period <= lastPeriod) continue;
        lastPeriod = period;
        engine->capture(frame);
        for (const Bodies::Body& body : bodies.rigid)
            samples[body.id].push_back(metric::sampleOf(frame, {.body = body.id}));
    }
    const BodyId measured = bodies.tool(tool, recording.string());
    for (const Bodies::Body& body : bodies.rigid)
        session.tracks.push_back({.name = body.name,
                                  .role = body.id == measured ? metric::Role::Tool : metric::Role::Other,
                                  .samples = std::move(samples[body.id])});
    return session;
}

} // namespace filasofia::app
