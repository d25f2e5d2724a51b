#include "filasofia/testing/fuzz_laws.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/core/word.h"
#include "filasofia/engine/scene/mechanical_energy.h"
#include "filasofia/engine/world.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "filasofia/testing/fuzz_law_scene.h"
#include "filasofia/testing/fuzz_stage.h"
#include "filasofia/testing/tissue_strain.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

namespace filasofia::testing {
namespace {

using namespace physics;

constexpr std::size_t kLawExamples = 40; ///< that a report keeps
constexpr double kLawGravity = 9.81;     ///< [m/s^2]
constexpr double kEnergyGain = 0.05; ///< [-] more than this is gained; steps that end a solve at its tolerance make 1 %
constexpr double kMassChange = 1e-3; ///< [-] crossings that are moved to nodes change volumes by up to 3e-4
constexpr double kSurelyBeyond = 1.001; ///< [-] strain over the valid one that single precision cannot miss
constexpr int kLookEvery = 8;           ///< steps between two looks at the energy, which cost as much as a step
constexpr int kMostCapped = 25;         ///< [-] steps at the iteration limit after which a scene ends: they take long
constexpr int kThreads[] = {2, 8};      ///< replays have these in turns

/// A file that is removed in the end.
struct ScratchRecording {
    std::filesystem::path path = std::filesystem::temp_directory_path() / text("filasofia_fuzz_laws_", getpid());

    ScratchRecording() = default;
    ScratchRecording(const ScratchRecording&) = delete;
    ScratchRecording& operator=(const ScratchRecording&) = delete;
    ~ScratchRecording()
    {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
    }
};

/// A scene that runs, is recorded and replayed, and what is counted of it.
class LawRun {
public:
    LawRun(std::size_t kind, std::uint64_t seed, LawFuzzReport& report)
        : report_(report), counts_(report.kinds[kind]), random_(seed), scene_(lawScene(kind, random_, counts_, report))
    {
        auto world = std::make_unique<engine::World>(engine::NativeEngineDef{.period = scene_.period, .threads = 1});
        world_ = world.get();
        server_ = std::make_unique<PhysicsServer>(std::move(world), PhysicsServerDef{{0, -kLawGravity, 0}});
        server_->keepLog(true);
        server_->hashEveryStep(true);
        for (const BodyDef& def : scene_.bodies)
            bodies_.push_back(std::visit([&](const auto& each) { return server_->add(each); }, def));
    }

    /// Returns the hash of its last state.
    std::uint64_t run(int threads, IterationCount& iterations, std::string called)
    {
        called_ = std::move(called);
        const ScratchRecording file;
        {
            record::RecordingWriter writer(file.path, {.period = scene_.period});
            for (step_ = 0; step_ < scene_.acting + scene_.calm && capped_ < kMostCapped; ++step_) {
                command();
                follow(server_->step(scene_.period), iterations);
                for (const StepRecord* each = server_->nextRecord(); each; each = server_->nextRecord()) {
                    writer.write(*each);
                    server_->popRecord();
                }
            }
        }
        finish();
        replay(file.path, threads);
        return server_->hash();
    }

private:
    [[nodiscard]] double time() const { return step_ * scene_.period; }
    [[nodiscard]] const std::vector<engine::SoftBody>& soft() const { return world_->scene().soft; }

    template <class What> void say(const What& what)
    {
        if (report_.examples.size() < kLawExamples)
            report_.examples.push_back(text(called_, ", ", time(), " s: ", what));
    }

    void command()
    {
        if (step_ == scene_.acting) // the floor too: contact moves what overlaps apart, which is work
            for (std::size_t b = 0; b < bodies_.size(); ++b)
                if (isRigid(scene_.bodies[b])) server_->remove(bodies_[b]);
        if (step_ >= scene_.acting) return;
        for (const ToldBody& each : scene_.told) server_->setPose(bodies_[each.body], each.at(time() + scene_.period));
        for (; event_ < scene_.events.size() && scene_.events[event_].time <= time() + 1e-9; ++event_) {
            scene_.events[event_].happen(*server_, bodies_);
            if (scene_.events[event_].changesRest) mustTellStrain_ = false;
        }
    }

    void follow(const StepReport& step, IterationCount& iterations)
    {
        iterations.add(step);
        if (step_ == 0) massesAtStart_ = masses();
        capped_ += step.has(StepFlag::NotConverged) ? 1 : 0;
        for (const Rupture& each : step.topology.ruptures)
            ++(each.kind == Rupture::Kind::Cut ? counts_.cuts : counts_.tears);
        if (step.has(StepFlag::Undone) && !std::exchange(undone_, true)) say("undone");
        for (const StepFlag flag : {StepFlag::Undone, StepFlag::NotConverged, StepFlag::Inverted})
            failed_ = failed_ || step.has(flag);
        if (!isFinite()) ++report_.notFinite, say("not finite");
        if (mustTellInverted_ && !step.has(StepFlag::Inverted))
            ++report_.silentInverted, say("elements were inside out, without a flag");
        if (mustTellStrain_ && !step.has(StepFlag::BeyondStrain))
            ++report_.silentStrain, say("elements were strained too far, without a flag");
        lookAhead();
        lookAtEnergy();
    }

    /// What the report of the next step must tell.
    void lookAhead()
    {
        mustTellInverted_ = std::ranges::any_of(soft(), [](const auto& each) { return surelyInverted(each) > 0; });
        inverted_ = inverted_ || mustTellInverted_;
        mustTellStrain_ = std::ranges::any_of(soft(), [&](const auto& each) {
            return largestInvariant(each) > kSurelyBeyond ||
                   (std::isfinite(scene_.validStrain) && largestStrain(each) > kSurelyBeyond * scene_.validStrain);
        });
    }

    void lookAtEnergy()
    {
        if (scene_.contracts || (step_ % kLookEvery != 0 && step_ != scene_.acting)) return;
        double stored = 0.0, motion = 0.0;
        for (const engine::SoftBody& each : soft()) {
            const physics::MechanicalEnergy energy = mechanicalEnergy(each, world_->scene().gravity);
            stored += energy.elastic;
            motion += energy.kinetic + energy.gravitational;
        }
        if (step_ <= scene_.acting) {
            mostStored_ = std::max(mostStored_, std::abs(stored));
            bound_ = stored + motion + (scene_.relaxes ? mostStored_ : 0.0);
            scale_ = std::abs(stored) + std::abs(motion) + (scene_.relaxes ? mostStored_ : 0.0);
            return;
        }
        const double gain = (stored + motion - bound_) / scale_;
        if (!failed_) report_.mostSilent = std::max(report_.mostSilent, gain);
        if (gain <= kEnergyGain || std::exchange(gained_, true)) return;
        say(text("energy has grown by ", 100.0 * gain, " %", failed_ ? " after a flag" : " without a flag"));
        ++counts_.gained;
        report_.silentGain += failed_ ? 0 : 1;
    }

    [[nodiscard]] bool isFinite() const
    {
        return std::ranges::all_of(soft(), [](const engine::SoftBody& each) {
            const auto numbers = [](Vec3 v) { return filasofia::isFinite(v); };
            return std::ranges::all_of(each.state.x, numbers) && std::ranges::all_of(each.state.v, numbers);
        });
    }

    [[nodiscard]] std::vector<double> masses() const
    {
        std::vector<double> sums;
        for (const engine::SoftBody& each : soft())
            sums.push_back(std::accumulate(each.model.masses.begin(), each.model.masses.end(), 0.0));
        return sums;
    }

    void finish()
    {
        const long steps = step_;
        counts_.notConverged += capped_;
        counts_.cutShort += capped_ < kMostCapped ? 0 : 1;
        ++counts_.scenes;
        ++report_.scenes;
        counts_.steps += steps;
        report_.steps += steps;
        report_.seconds += static_cast<double>(steps) * scene_.period;
        counts_.inverted += inverted_ ? 1 : 0;
        counts_.stillInverted += mustTellInverted_ ? 1 : 0;
        counts_.undone += undone_ ? 1 : 0;
        const std::vector<double> now = masses();
        for (std::size_t b = 0; b < now.size(); ++b)
            if (std::abs(now[b] - massesAtStart_[b]) > kMassChange * massesAtStart_[b])
                ++report_.massChanged, say(text("a mass of ", massesAtStart_[b], " kg is now ", now[b], " kg"));
    }

    void replay(const std::filesystem::path& file, int threads)
    {
        ++report_.replays;
        try {
            const auto engine = engine::makeNativeEngine({.period = scene_.period, .threads = threads});
            const auto difference = record::replay(record::readRecording(file).steps, *engine);
            if (!difference) return;
            say(text("with ", threads, " threads step ", difference->step, " has another hash"));
        } catch (const Error& error) {
            say(text("its recording was refused: ", error.what()));
        }
        ++report_.hashesThatDiffer;
    }

    LawFuzzReport& report_;
    LawFuzzKind& counts_;
    FuzzRandom random_;
    LawScene scene_;
    engine::World* world_ = nullptr; ///< the server's
    std::unique_ptr<PhysicsServer> server_;
    std::vector<BodyId> bodies_;
    std::string called_;
    int step_ = 0, capped_ = 0;
    std::size_t event_ = 0;
    std::vector<double> massesAtStart_;                   ///< [kg] per soft body
    double mostStored_ = 0.0, bound_ = 0.0, scale_ = 1.0; ///< [J]
    bool inverted_ = false, mustTellInverted_ = false, mustTellStrain_ = false, gained_ = false;
    bool failed_ = false, undone_ = false;
};

/// Whether the tissue that tools act on begins with fibres: its scene is made once more, which costs little.
bool hasFibres(std::size_t kind, std::uint64_t seed)
{
    FuzzRandom random(seed);
    LawFuzzKind counts;
    LawFuzzReport report;
    const LawScene scene = lawScene(kind, random, counts, report);
    const auto* fem = std::get_if<FemMaterial>(&std::get<SoftBodyDef>(scene.bodies[kTissue]).material);
    return fem && !fem->fibres.empty();
}

bool isWanted(const LawFuzzDef& def, std::uint64_t number)
{
    const std::size_t kind = number % kLawKinds;
    return (def.law.empty() || def.law == nameOfLawKind(kind)) &&
           (!def.fibres || hasFibres(kind, seedOfScene(def.seed, number)));
}

void check(const LawFuzzDef& def)
{
    const std::vector<std::string> kinds = lawFuzzKinds();
    if (!def.law.empty() && std::ranges::find(kinds, def.law) == kinds.end())
        fail("fuzz: unknown law '", shortened(def.law), "'");
    if (def.fibres && def.law == kinds.back()) fail("fuzz: shells have no fibres");
}

} // namespace

std::vector<std::string> lawFuzzKinds()
{
    std::vector<std::string> all;
    for (std::size_t kind = 0; kind < kLawKinds; ++kind) all.push_back(nameOfLawKind(kind));
    return all;
}

LawFuzzReport fuzzLaws(const LawFuzzDef& def)
{
    check(def);
    LawFuzzReport report;
    for (const std::string& each : lawFuzzKinds()) report.kinds.push_back({each});
    IterationCount iterations;
    Hasher all;
    for (int index = def.first; report.scenes < def.scenes; ++index) {
        const auto number = static_cast<std::uint64_t>(index);
        if (!isWanted(def, number)) continue;
        const std::size_t kind = number % kLawKinds;
        LawRun run(kind, seedOfScene(def.seed, number), report);
        all.add(run.run(kThreads[number / kLawKinds % std::size(kThreads)], iterations,
                        text("scene ", index, " (", report.kinds[kind].name, ")")));
        if (def.progress) def.progress(static_cast<int>(report.scenes));
    }
    summarise(iterations, all, report);
    return report;
}

} // namespace filasofia::testing
