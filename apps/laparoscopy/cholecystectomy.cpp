#include "apps/laparoscopy/gallbladder.h"

#include <filasofia/core/disjoint_sets.h>

#include <cstdio>
#include <map>
#include <utility>

using namespace filasofia;

namespace operation {
namespace {

constexpr double kLimits[] = {600, 420, 240}; ///< [s], by difficulty
constexpr double kOut = 42_mm;                ///< [m] towards the surgeon
constexpr double kDrop = 0.05e-6;             ///< [m^3] what a tube may lose while it is cut between clips
constexpr double kFree = 0.1;                 ///< [-], share of the lower bed that may still hold in a critical view

/// The part of a surface that most of these nodes are on.
int partOf(const std::vector<int>& nodes, DisjointSets& parts)
{
    std::map<int, int> votes;
    for (const int node : nodes) ++votes[parts.find(node)];
    return std::ranges::max_element(votes, {}, [](const auto& each) { return each.second; })->first;
}

/// Watches the patient before every step, by the rules of the operation.
class Surgery {
public:
    Surgery(Simulation& sim, const GallbladderPatient& patient) : sim_(sim), patient_(patient)
    {
        const auto ids = sim.physics().attachments(patient.gallbladder);
        bed_ = {ids[0], ids[1]};
        const auto holds = sim.physics().attachments(patient.layer);
        holds_ = {holds[0], holds[1]};
        const auto layer = sim.physics().def(patient.layer);
        for (std::size_t i : {0, 1}) rows_[i] = std::get<SoftBodyDef>(*layer).attachments[i].nodes;
        sim.everyStep([this](double) { watch(); });
    }
    std::function<void(const std::string&)> mistake;

    /// What a surgeon shows before anything is clipped (Strasberg 1995, 2010): the triangle is cleared, the lower third
    /// of the gall bladder is off the liver, and two structures, whole, enter it.
    [[nodiscard]] bool criticalView() const
    {
        return layerOpen_ && lowerBed() <= kFree && isWhole(patient_.duct) && isWhole(patient_.artery);
    }
    void clipped(BodyId tissue)
    {
        if (!tissue) return mistake("clip lost");
        if (!std::exchange(begun_, true)) viewed_ = criticalView();
        if (!viewed_ && !std::exchange(told_, true)) mistake("clipped without a critical view");
    }
    [[nodiscard]] bool viewed() const { return viewed_; }
    [[nodiscard]] bool layerOpen() const { return layerOpen_; }
    [[nodiscard]] bool lowerFree() const { return lowerBed() <= kFree; }
    [[nodiscard]] bool detached() const { return seen() && points_[0] + points_[1] == 0; }
    [[nodiscard]] DuctBalance of(const PatientTube& tube) const { return sim_.duct(tube.body); }
    [[nodiscard]] bool isWhole(const PatientTube& tube) const
    {
        const DuctState state = of(tube).state;
        return state == DuctState::Open || state == DuctState::Clipped;
    }
    [[nodiscard]] bool isCut(const PatientTube& tube) const { return !isWhole(tube); }
    [[nodiscard]] int clipsOn(const PatientTube& tube) const { return of(tube).clipsBefore + of(tube).clipsAfter; }
    /// [m^3], bile and blood that ran out of cut ends, and blood from elsewhere. That on an artery's surface is the
    /// same.
    [[nodiscard]] double bile() const { return of(patient_.duct).lost; }
    [[nodiscard]] double blood() const
    {
        const double artery = std::max(of(patient_.artery).lost, sim_.blood(patient_.artery.body).welled);
        return artery + sim_.blood(patient_.liver).welled;
    }
    /// [m^2], on what is no target.
    [[nodiscard]] double burnt() const
    {
        return sim_.heat(patient_.liver).burnt + sim_.heat(patient_.duct.body).burnt +
               sim_.heat(patient_.artery.body).burnt;
    }
    [[nodiscard]] double lowerBed() const
    {
        return seen() ? static_cast<double>(points_[0]) / std::max(1, all_[0].load()) : 1.0;
    }

private:
    [[nodiscard]] bool seen() const { return all_[0] + all_[1] > 0; } ///< before the first frame nothing is known
    void watch()
    {
        const FrameRef now = sim_.physics().latest();
        if (!now) return;
        for (std::size_t i = 0; i < 2; ++i) {
            int points = 0;
            for (const auto& each : now->attachments)
                if (each.id == bed_[i]) points = each.points;
            points_[i] = points;
            all_[i] = std::max(all_[i].load(), points);
        }
        if (!layerOpen_) layerOpen_ = isLayerOpen(*now);
        const auto leaks = [&](const PatientTube& tube, bool& was, const char* what) {
            if (of(tube).lost > kDrop && !std::exchange(was, true)) mistake(what);
        };
        leaks(patient_.duct, bileTold_, "bile leaks");
        leaks(patient_.artery, bloodTold_, "artery bleeds");
    }
    /// The layer has come apart between its tubes, and each has a part of it: not a sliver that came off somewhere.
    [[nodiscard]] bool isLayerOpen(const frame::Frame& now)
    {
        const frame::SoftBodyFrame* layer = now.softBody(patient_.layer);
        if (layer == nullptr || !layer->boundary) return false;
        if (std::exchange(layerRevision_, layer->boundary->revision) == layer->boundary->revision) return false;
        for (const AttachmentId id : holds_) {
            const auto found = std::ranges::find(now.attachments, id, &frame::Attachment::id);
            if (found == now.attachments.end() || found->points == 0) return false;
        }
        DisjointSets parts(layer->positions.size());
        for (const auto& [a, b, c] : layer->boundary->triangles) {
            parts.join(a, b);
            parts.join(b, c);
        }
        return partOf(rows_[0], parts) != partOf(rows_[1], parts);
    }

    Simulation& sim_;
    const GallbladderPatient& patient_;
    std::array<AttachmentId, 2> bed_ = {},
                                holds_ = {};    ///< what the gall bladder has on the liver, and the layer on the tubes
    std::array<std::vector<int>, 2> rows_ = {}; ///< nodes of the layer at the artery, and at the duct
    std::uint64_t layerRevision_ = 0;
    std::array<std::atomic<int>, 2> points_ = {}, all_ = {};
    std::atomic<bool> layerOpen_ = false, viewed_ = false;
    bool begun_ = false, told_ = false, bileTold_ = false, bloodTold_ = false;
};

std::vector<TaskStep> stepsOf(const GallbladderPatient& patient, const GallbladderTools& tools, const Surgery& surgery)
{
    const auto step = [](const char* name, const char* instruction, const auto& done) {
        return TaskStep{.name = name, .instruction = instruction, .done = [done](const auto&) { return done(); }};
    };
    return {
        step("grasp", "Grasp the neck of the gall bladder with the left hand, and draw it aside",
             [&] { return tools.left.tool().holding() == patient.gallbladder; }),
        step("triangle", "4: the hook. Open the layer between duct and artery", [&] { return surgery.layerOpen(); }),
        step("view", "Free the lower third of the gall bladder from the liver", [&] { return surgery.lowerFree(); }),
        step("clip duct", "5: clips. Two on the duct far from the gall bladder, and one near it",
             [&] { return surgery.clipsOn(patient.duct) >= 3; }),
        step("clip artery", "The same on the artery", [&] { return surgery.clipsOn(patient.artery) >= 3; }),
        step("cut", "6: scissors. Cut both, between two clips and one",
             [&] { return surgery.isCut(patient.duct) && surgery.isCut(patient.artery); }),
        step("detach", "4: the hook. Free the gall bladder from its bed, and bring it out",
             [&] { return surgery.detached() && tools.left.tool().grip().z > kOut; }),
    };
}

MetricTrackerDef observedOf(const Training& training, const GallbladderTools& tools, const char* difficulty)
{
    MetricTrackerDef observed{
        .bodies = {{.body = tools.left.body(), .tip = {0, 0, -18_mm}},
                   {.body = tools.scope.body(), .role = Role::Scope, .element = Endoscope::kCamera}},
        .file = training.file};
    for (const auto& each : tools.right) observed.bodies.push_back({.body = each->body(), .tip = {0, 0, -12_mm}});
    observed.session = {.trainee = training.trainee,
                        .task = text("cholecystectomy ", difficulty),
                        .software = "Filasofia",
                        .seed = static_cast<std::uint64_t>(training.seed),
                        .fieldOfView = tools.scope.def().fieldOfView,
                        .targets = {"layer", "duct", "artery"},
                        .watched = {EventKind::Mistake}};
    return observed;
}

std::vector<ResultLine> resultsOf(const TaskProgress& progress, const Surgery& surgery, const ClipApplier& clips)
{
    const auto millilitres = [](double volume) { return text(std::round(volume * 1e8) / 100.0, " ml"); };
    return {{"Time", text(std::lround(progress.time), " s")},
            {"Critical view", surgery.viewed() ? "yes" : "no"},
            {"Clips", text(clips.applied(), clips.missed() > 0 ? text(", lost ", clips.missed()) : "")},
            {"Bile lost", millilitres(surgery.bile())},
            {"Blood lost", millilitres(surgery.blood())},
            {"Burnt beside", text(std::lround(surgery.burnt() * 1e6), " mm^2")}};
}

} // namespace

int cholecystectomy(const Training& training)
{
    static constexpr const char* kNames[] = {"easy", "normal", "hard"};
    if (training.device) fail("cholecystectomy: a haptic device holds the right handle in peg-transfer only");
    Simulation sim({.window = {"Cholecystectomy", 960, 720}, .look = {.mouse = false, .keys = false}});
    const GallbladderPatient patient = addGallbladder(sim, static_cast<std::uint64_t>(training.seed));
    GallbladderTools tools(sim, patient);
    Surgery surgery(sim, patient);
    const std::vector<TaskStep> taskSteps = stepsOf(patient, tools, surgery);
    MetricTrackerDef observed = observedOf(training, tools, kNames[training.difficulty]);
    for (const TaskStep& step : taskSteps) observed.session.steps.push_back(step.name);
    MetricTracker tracker(sim, observed);
    surgery.mistake = [&](const std::string& what) { tracker.mark(EventKind::Mistake, what); };
    tools.onClip = [&](BodyId tissue) { surgery.clipped(tissue); };
    sim.on<KeyEvent>([&](const KeyEvent& e) {
        for (const InHand each : {Hook, Applier, Scissors})
            if (e.pressed && e.key == static_cast<KeyCode>(static_cast<int>(KeyCode::Digit4) + each))
                tools.choose(each);
    });
    const ForceBar bar(sim, {.name = "Force of the grasper", .bodies = {tools.left.body()}, .warning = 5, .full = 10});
    TrainingSession session(sim, training);
    const Task* running = nullptr;
    const auto over = [&](bool done) {
        session.over(done ? "The gall bladder is free" : "Time is up",
                     [&] { return resultsOf(running->progress(), surgery, tools.clips); });
    };
    const Task task(sim, {.name = "cholecystectomy",
                          .steps = taskSteps,
                          .timeLimit = kLimits[training.difficulty],
                          .tracker = &tracker,
                          .over = over});
    running = &task;
    Guidance guidance(sim, task);
    session.guide(guidance, training.difficulty == 0 && training.motion.empty());
    sim.dress([&](VisualServer& server) {
        tools.scope.dress(server);
        guidance.dress(server);
    });
    const GallbladderMotion with{sim, patient, tools, [&](const char* name) { return session.picture(name); }};
    std::vector<TrocarMove> moves;
    if (training.motion == "expert") moves = expertMotion(with);
    if (training.motion == "clumsy") moves = clumsyMotion(with, static_cast<std::uint64_t>(training.seed));
    double seconds = 0.0;
    for (const TrocarMove& each : moves) seconds += each.seconds;
    if (!moves.empty()) tools.hands.play(moves);
    const auto steps = static_cast<int>(1000 * seconds);
    if (const int problem = session.run(steps > 0 ? steps + 100 : 0)) return problem;
    tracker.close();
    const TaskProgress progress = task.progress();
    const bool done = progress.state == TaskProgress::State::Done;
    std::printf(
        "%s: %d of %zu steps in %.1f s; critical view %s, clips %d (%d lost), bile %.2f ml, blood %.2f ml, burnt "
        "beside %.0f mm^2, highest force %.2f N; session%s: %s\n",
        done ? "done" : "not done", progress.step, taskSteps.size(), progress.time, surgery.viewed() ? "yes" : "no",
        tools.clips.applied(), tools.clips.missed(), surgery.bile() * 1e6, surgery.blood() * 1e6, surgery.burnt() * 1e6,
        bar.highest(), tracker.failed() ? " (incomplete)" : "", training.file.c_str());
    if (tracker.failed()) return 1;
    return training.motion == "expert" && !session.cutShort() && !done ? 1 : 0;
}

} // namespace operation
