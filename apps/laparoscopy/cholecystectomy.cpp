#include "apps/laparoscopy/box.h"
#include "apps/laparoscopy/gallbladder.h"

#include <filasofia/core/disjoint_sets.h>

#include <cstdio>
#include <map>
#include <utility>

using namespace filasofia;

namespace operation {
namespace {

using laparoscopy::Rules;
constexpr Rules kRules[] = {{true, 600}, {false, 420}, {false, 240}}; ///< by difficulty
constexpr double kOut = 42_mm;                                        ///< [m] towards the surgeon
constexpr double kDrop = 0.05e-6;     ///< [m^3] what a tube may lose while it is cut between clips
constexpr double kStrand = 3.0;       ///< [-], length over that at rest
constexpr double kIn = 0.95;          ///< [-], share of the gall bladder in the bag
constexpr double kAtPort = 75_mm;     ///< [m], how deep the shaft of a bag at its port is inside
constexpr std::uint64_t kLooks = 100; ///< [-], steps from look to look into the bag
constexpr double kFree = 0.1;         ///< [-], share of the lower bed that may still hold in a critical view

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
    Surgery(Simulation& sim, const GallbladderPatient& patient, const GallbladderTools& tools)
        : sim_(sim), patient_(patient), tools_(tools)
    {
        const auto ids = sim.physics().attachments(patient.gallbladder);
        bed_ = {ids[0], ids[1]};
        const auto holds = sim.physics().attachments(patient.layer);
        holds_ = {holds[0], holds[1]};
        const auto layer = sim.physics().def(patient.layer);
        for (std::size_t i : {0, 1}) rows_[i] = std::get<SoftBodyDef>(*layer).attachments[i].nodes;
        sim.everyStep([this](double) { watch(); });
    }
    std::function<void(EventKind, const std::string&)> mark; ///< called for what is recorded

    /// What a surgeon shows before anything is clipped (Strasberg 1995, 2010): the triangle is cleared, the lower third
    /// of the gall bladder is off the liver, and two structures, whole, enter it.
    [[nodiscard]] bool criticalView() const
    {
        return layerOpen_ && lowerBed() <= kFree && isWhole(patient_.duct) && isWhole(patient_.artery);
    }
    void clipped(BodyId tissue)
    {
        if (!tissue) return mistake("clip lost");
        if (std::exchange(begun_, true)) return;
        viewed_ = criticalView();
        mark(EventKind::Note, viewed_ ? "critical view of safety shown" : "no critical view of safety");
        if (!viewed_) mistake("clipped without a critical view");
    }
    [[nodiscard]] bool viewed() const { return viewed_; }
    [[nodiscard]] bool layerOpen() const { return layerOpen_; }
    [[nodiscard]] bool lowerFree() const { return lowerBed() <= kFree; }
    [[nodiscard]] bool detached() const { return seen() && points_[0] + points_[1] == 0; }
    [[nodiscard]] DuctBalance of(const PatientTube& tube) const { return sim_.duct(tube.body); }
    [[nodiscard]] bool isWhole(const PatientTube& tube) const { return surface::isWhole(of(tube).state); }
    [[nodiscard]] bool isCut(const PatientTube& tube) const { return !isWhole(tube); }
    [[nodiscard]] int clipsOn(const PatientTube& tube) const { return of(tube).clipsBefore + of(tube).clipsAfter; }
    /// [m^3], what ran out of the duct's cut ends, and all blood: what runs out of the artery's is among it.
    [[nodiscard]] double bile() const { return of(patient_.duct).lost; }
    [[nodiscard]] double blood() const
    {
        return sim_.blood(patient_.artery.body).welled + sim_.blood(patient_.liver).welled;
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

    [[nodiscard]] double inBag() const { return inBag_; } ///< [-], share of the gall bladder
    [[nodiscard]] bool bagged() const { return inBag_ >= kIn && tools_.left.tool().holding() != patient_.gallbladder; }
    /// In the closed bag, at the port.
    [[nodiscard]] bool retrieved() const
    {
        const LaparoscopicInstrument& holder = *tools_.right[Bag];
        return bagged() && holder.tool().opening() < 0.2 && holder.report().pose.insertion < kAtPort;
    }

    /// The gall bladder is off its bed, and a strand of the layer still ties it to what stays.
    [[nodiscard]] bool strand() const { return detached() && strand_; }

private:
    void mistake(const char* what) const { mark(EventKind::Mistake, what); }
    /// Nothing but a strand that is drawn out is so long.
    [[nodiscard]] bool isStretched(const frame::Frame& now) const
    {
        const frame::SoftBodyFrame* layer = now.softBody(patient_.layer);
        if (layer == nullptr || !layer->boundary || layer->boundary->rest.empty()) return false;
        return std::ranges::any_of(layer->boundary->triangles, [&](const auto& t) {
            const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]);
            return distance(layer->positions[a], layer->positions[b]) >
                   kStrand * distance(layer->boundary->rest[a], layer->boundary->rest[b]);
        });
    }
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
        if (bile() > kDrop && !std::exchange(bileTold_, true)) mistake("bile leaks");
        if (sim_.blood(patient_.artery.body).welled > kDrop && !std::exchange(bloodTold_, true))
            mistake("artery bleeds");
        strand_ = isStretched(*now);
        if (!detached()) return;
        if (!std::exchange(letGo_, true))
            for (const auto& each : now->attachments) // the assistant lets go
                if (each.body == patient_.gallbladder && each.to == patient_.assistant) sim_.physics().release(each.id);
        if (now->step % kLooks == 0) inBag_ = tools_.bag.share(patient_.gallbladder);
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
    const GallbladderTools& tools_;
    std::array<AttachmentId, 2> bed_ = {},
                                holds_ = {};    ///< what the gall bladder has on the liver, and the layer on the tubes
    std::array<std::vector<int>, 2> rows_ = {}; ///< nodes of the layer at the artery, and at the duct
    std::uint64_t layerRevision_ = 0;
    std::array<std::atomic<int>, 2> points_ = {}, all_ = {};
    std::atomic<double> inBag_ = 0.0;
    std::atomic<bool> layerOpen_ = false, viewed_ = false, strand_ = false;
    bool begun_ = false, letGo_ = false, bileTold_ = false, bloodTold_ = false;
};

std::vector<TaskStep> stepsOf(const GallbladderPatient& patient, const GallbladderTools& tools, const Surgery& surgery)
{
    return {
        laparoscopy::step("grasp", "Grasp the neck of the gall bladder with the left hand, and draw it aside",
                          [&] { return tools.left.tool().holding() == patient.gallbladder; }),
        laparoscopy::step("triangle", "4: the hook. Open the layer between duct and artery",
                          [&] { return surgery.layerOpen(); }),
        laparoscopy::step("view", "Free the lower third of the gall bladder from the liver",
                          [&] { return surgery.lowerFree(); }),
        laparoscopy::step("clip duct", "5: clips. Two on the duct far from the gall bladder, and one near it",
                          [&] { return surgery.clipsOn(patient.duct) >= 3; }),
        laparoscopy::step("clip artery", "The same on the artery",
                          [&] { return surgery.clipsOn(patient.artery) >= 3; }),
        laparoscopy::step("cut", "6: scissors. Cut both, between two clips and one",
                          [&] { return surgery.isCut(patient.duct) && surgery.isCut(patient.artery); }),
        laparoscopy::step("detach", "4: the hook. Free the gall bladder from its bed, and bring it out",
                          [&] { return surgery.detached() && tools.left.tool().grip().z > kOut; }),
        laparoscopy::step("bag", "7: the bag. Lower the gall bladder into it, and let go",
                          [&] { return surgery.bagged(); }),
        laparoscopy::step("retrieve", "Close the bag, and draw it back to its port",
                          [&] { return surgery.retrieved(); }),
    };
}

MetricTrackerDef observedOf(const GallbladderTools& tools, const Training& training)
{
    MetricTrackerDef observed{
        .bodies = {{.body = tools.left.body(), .tip = {0, 0, -18_mm}},
                   {.body = tools.scope.body(), .role = Role::Scope, .element = Endoscope::kCamera}}};
    for (const auto& each : tools.right) observed.bodies.push_back({.body = each->body(), .tip = {0, 0, -12_mm}});
    observed.session = {.task = training.task("cholecystectomy"),
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
            {"Burnt beside", text(std::lround(surgery.burnt() * 1e6), " mm^2")},
            {"Retrieved", surgery.retrieved() ? "yes" : text(std::lround(100 * surgery.inBag()), " % in the bag")},
            {"Layer", surgery.strand() ? "a strand still holds" : "nothing of it holds"}};
}

} // namespace

std::vector<TrainerSetting> settings() { return laparoscopy::settingsOf("cholecystectomy", kRules); }

int cholecystectomy(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    Simulation sim({.window = {"Cholecystectomy", 960, 720}, .look = {.mouse = false, .keys = false}});
    const auto seed = static_cast<std::uint64_t>(training.seed);
    const GallbladderPatient patient = addGallbladder(sim, seed);
    GallbladderTools tools(sim, patient);
    Surgery surgery(sim, patient, tools);
    sim.on<KeyEvent>([&](const KeyEvent& e) {
        if (e.key == KeyCode::Digit9) tools.suction.rinse(e.pressed && tools.chosen() == Tube);
        for (const InHand each : {Hook, Applier, Scissors, Bag, Tube})
            if (e.pressed && e.key == static_cast<KeyCode>(static_cast<int>(KeyCode::Digit4) + each))
                tools.choose(each);
    });
    TrainerTask task(
        sim, training,
        {.steps = stepsOf(patient, tools, surgery),
         .timeLimit = rules.timeLimit,
         .guided = rules.guided,
         .observed = observedOf(tools, training),
         .force = {.name = "Force of the grasper", .bodies = {tools.left.body()}, .warning = 5, .full = 10},
         .done = "The gall bladder is out",
         .dress = [&](VisualServer& server) { tools.scope.dress(server); },
         .results = [&](const TaskProgress& now) { return resultsOf(now, surgery, tools.clips); }});
    surgery.mark = [&](EventKind kind, const std::string& what) { task.tracker().mark(kind, what); };
    tools.onClip = [&](BodyId tissue) { surgery.clipped(tissue); };
    const GallbladderMotion with{sim, patient, tools, [&](const char* name) { return task.picture(name); }};
    std::vector<TrocarMove> moves;
    if (training.motion == "expert") moves = expertMotion(with);
    if (training.motion == "clumsy") moves = clumsyMotion(with, seed);
    if (!moves.empty()) tools.hands.play(moves);
    return task.run(moves.empty() ? 0 : laparoscopy::stepsIn(prefab::durationOf(moves) + 0.1), [&] {
        char line[240] = {};
        std::snprintf(line, sizeof line,
                      "critical view %s, clips %d (%d lost), bile %.2f ml, blood %.2f ml, burnt beside %.0f mm^2, "
                      "%.0f %% in the bag, retrieved %s%s",
                      surgery.viewed() ? "yes" : "no", tools.clips.applied(), tools.clips.missed(),
                      surgery.bile() * 1e6, surgery.blood() * 1e6, surgery.burnt() * 1e6, 100 * surgery.inBag(),
                      surgery.retrieved() ? "yes" : "no", surgery.strand() ? ", a strand holds" : "");
        return std::string(line);
    });
}

} // namespace operation
