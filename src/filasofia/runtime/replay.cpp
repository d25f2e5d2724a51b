#include "filasofia/runtime/replay.h"

#include "filasofia/core/validate.h"
#include "filasofia/runtime/check_file.h"
#include "filasofia/runtime/engines.h"
#include "filasofia/runtime/scene_player.h"

#include <chrono>

namespace filasofia::runtime {
namespace {

/// The next step; nothing at the session's end, or if the file is damaged.
std::optional<physics::StepRecord> nextOf(record::RecordingReader& reader, ReplayReport& report)
{
    try {
        return reader.next();
    } catch (const Error& damage) {
        report.damage = damage.what();
        return std::nullopt;
    }
}

} // namespace

ReplayReport replay(const ReplayDef& def)
{
    validate(def, "replay");
    checkFile("replay", def.picture, "picture", ".png");
    checkVideoFile("replay", def.video);
    record::RecordingReader reader(def.file);
    ReplayReport report{.header = reader.header()};
    const SimulationDef any; // its physics is that of the engine
    Simulation::Impl impl(any, makeReplayEngine(report.header, def.file, def.threads));
    record::Replayer replayer(impl.physics);
    ScenePlayer scene(impl, def);

    const auto start = std::chrono::steady_clock::now();
    while (true) {
        const std::optional<physics::StepRecord> recorded = nextOf(reader, report);
        scene.take(reader.takeScene());
        if (report.made > 0) scene.draw(); // the last step, with what happened after it
        if (!recorded) break;
        const physics::StepReport made = replayer.step(*recorded, [&] { scene.beforeStep(); });
        impl.now.set(made.time, made.step);
        scene.afterStep();
        ++report.made;
        if (!def.check || report.unhashed > 0) continue;
        if (recorded->hash == 0)
            report.unhashed = made.step;
        else if (const std::uint64_t hash = impl.physics.hash(); hash != recorded->hash) {
            report.difference = record::Difference{made.step, recorded->hash, hash};
            break;
        }
    }
    scene.last(report);
    report.wallSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report.step = impl.now.step();
    report.time = impl.now.seconds();
    report.hash = impl.physics.hash();
    return report;
}

} // namespace filasofia::runtime
