#include "apps/laparoscopy/drain.h"
#include "apps/laparoscopy/duct.h"
#include "apps/laparoscopy/endoloop.h"
#include "apps/laparoscopy/gallbladder.h"
#include "apps/laparoscopy/gauze.h"
#include "apps/laparoscopy/motion.h"

#include <utility>

using namespace filasofia;
using namespace laparoscopy;

namespace {

constexpr double kCutoff = 300.0;                                             ///< [s] in the published score
constexpr Rules kRules[] = {{true, kCutoff}, {false, kCutoff}, {false, 120}}; ///< by difficulty
/// What more a case file may change.
struct Rings {
    int rings = kPegs;
    bool back = true;
};
constexpr auto fields(const Rings*)
{
    return describe("Rings", field("rings", &Rings::rings, "-", closed(1, kPegs), "to be brought over"),
                    field("back", &Rings::back, "whether they have to go back again"));
}
constexpr Rings kRings[] = {{3, false}, {}, {}}; ///< by difficulty

/// Judges the rings before every step, by the rules of the task: taken up by one hand, given to the other in the air,
/// put onto a peg of the other side.
class Judge {
public:
    Judge(Simulation& sim, const PegBox& box, std::array<const LaparoscopicInstrument*, 2> tools)
        : sim_(sim), box_(box), tools_(tools), rings_(box.rings.size())
    {
        sim.everyStep([this](double time) { watch(time); });
    }
    std::function<void(EventKind, const std::string&)> mark; ///< called for what is recorded

    [[nodiscard]] int count(Side to) const { return counts_[to]; } ///< rings that were brought there
    [[nodiscard]] int lost() const { return lost_; }
    [[nodiscard]] int drops() const { return drops_; }

private:
    struct Ring {
        std::array<bool, 2> held = {};
        std::optional<Side> given = {}; ///< which hand got it in the air
        std::array<bool, 2> counted = {};
        std::optional<double> let = {}; ///< [s], when it was let go
        bool lost = false;
    };
    void watch(double time)
    {
        const FrameRef now = sim_.physics().latest();
        if (!now) return;
        for (std::size_t i = 0; i < rings_.size(); ++i)
            judge(rings_[i], i, now->rigidBody(box_.rings[i])->poses[0], time);
    }
    void judge(Ring& ring, std::size_t index, const Pose& pose, double time)
    {
        if (ring.lost) return;
        const auto was = std::exchange(ring.held, {holds(LeftSide, index), holds(RightSide, index)});
        const bool held = ring.held[LeftSide] || ring.held[RightSide];
        if (was[LeftSide] && was[RightSide] && ring.held[LeftSide] != ring.held[RightSide] && pose.position.y > 15_mm)
            ring.given = ring.held[LeftSide] ? LeftSide : RightSide;
        if (!held && pose.position.y < -2_mm) { // it has left the board
            ring.lost = true;
            ++lost_;
            return mark(EventKind::Mistake, text("ring ", index + 1, " lost"));
        }
        if (held)
            ring.let.reset();
        else if (was[LeftSide] || was[RightSide])
            ring.let = time;
        if (ring.let && time - *ring.let >= 0.4) rest(ring, index, pose);
    }
    /// A ring that was let go has come to rest.
    void rest(Ring& ring, std::size_t index, const Pose& pose)
    {
        ring.let.reset();
        const auto given = std::exchange(ring.given, {});
        for (const Side side : {LeftSide, RightSide})
            if (pegOf(pose, side)) {
                const bool counts =
                    given == side && !ring.counted[side] && (side == RightSide || ring.counted[RightSide]);
                if (counts) ++counts_[side];
                ring.counted[side] = ring.counted[side] || counts;
                return;
            }
        ++drops_;
        mark(EventKind::Mistake, text("ring ", index + 1, " dropped"));
    }
    [[nodiscard]] bool holds(Side side, std::size_t index) const
    {
        return tools_[side]->tool().holding() == box_.rings[index];
    }

    Simulation& sim_;
    const PegBox& box_;
    const std::array<const LaparoscopicInstrument*, 2> tools_;
    std::vector<Ring> rings_;
    std::array<std::atomic<int>, 2> counts_ = {};
    std::atomic<int> lost_ = 0, drops_ = 0;
};

std::vector<TaskStep> stepsOf(const Rings& rings, const Judge& judge)
{
    std::vector<TaskStep> steps;
    const auto add = [&](Side to, const char* name, const char* instruction) {
        for (int i = 1; i <= rings.rings; ++i)
            steps.push_back({.name = text(name, i), .instruction = instruction, .done = [&judge, to, i](const auto&) {
                                 return judge.count(to) + judge.lost() >= i;
                             }});
    };
    add(RightSide, "over ", "Take a ring with the left hand, give it to the right one, put it onto a peg");
    if (rings.back) add(LeftSide, "back ", "And back: the right hand takes it, the left one gets it in the air");
    return steps;
}

int pegTransfer(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const Rings rings = training.rules(kRings[training.difficulty]);
    const auto seed = static_cast<std::uint64_t>(training.seed);
    Simulation sim({.physics = {.contact = PenaltyContact{.stiffness = 1e4, .damping = 2.0}},
                    .window = {"Laparoscopy", 960, 720},
                    .look = {.mouse = false, .keys = false}});
    const PegBox box = addBox(sim, rings.rings, seed);
    MetricTracker* marks = nullptr;
    LaparoscopicInstrumentDef leftDef = instrumentOf(LeftSide, training), rightDef = instrumentOf(RightSide, training);
    leftDef.tool.onGrasp = rightDef.tool.onGrasp = [&](BodyId ring, bool on) {
        const auto index = std::ranges::find(box.rings, ring) - box.rings.begin();
        marks->mark(on ? EventKind::Grasp : EventKind::Release, text("ring ", index + 1));
    };
    LaparoscopicInstrument left(sim, leftDef), right(sim, rightDef);
    Laparoscope scope(sim, scopeOf());
    TrocarHands hands(sim, left, right, scope, handsOf(sim, left, right));
    Judge judge(sim, box, {&left, &right});
    // McGill's raw score (Derossis et al. 1998): the cutoff time less the time, less the percentage of lost objects.
    const auto score = [&](const TaskProgress& now) {
        if (now.state != TaskProgress::State::Done) return 0.0;
        return std::max(0.0, kCutoff - now.time - 100.0 * judge.lost() / rings.rings);
    };
    const TrainerTask* running = nullptr;
    TrainerTaskDef def{
        .steps = stepsOf(rings, judge),
        .timeLimit = rules.timeLimit,
        .guided = rules.guided,
        .force = {.name = "Force of the instruments", .bodies = {left.body(), right.body()}, .warning = 5, .full = 10},
        .done = "All rings are in place",
        .dress = [&](VisualServer& server) { scope.dress(server); },
        .results =
            [&](const TaskProgress& now) {
                return std::vector<ResultLine>{
                    {"Time", text(std::lround(now.time), " s")},
                    {"Dropped", text(judge.drops())},
                    {"Lost", text(judge.lost())},
                    {"Score", text(std::lround(score(now)), " of 300")},
                    {"Highest total force", text(std::lround(1000 * running->force().highest()), " mN")}};
            },
        .score = score};
    def.observed.bodies = observedIn(left, right, scope);
    def.observed.session = {.task = training.task("peg transfer"),
                            .fieldOfView = scope.def().fieldOfView,
                            .watched = {EventKind::Grasp, EventKind::Release, EventKind::Mistake}};
    for (int i = 1; i <= rings.rings; ++i) def.observed.session.targets.push_back(text("ring ", i));
    TrainerTask task(sim, training, def);
    running = &task;
    marks = &task.tracker();
    judge.mark = [&](EventKind kind, const std::string& what) { task.tracker().mark(kind, what); };

    const Motion with{sim, box, {&left, &right}, rings.back, [&](const char* name) { return task.picture(name); }};
    std::vector<TrocarMove> moves;
    if (training.motion == "expert") moves = expertMotion(with);
    if (training.motion == "clumsy") moves = clumsyMotion(with, seed);
    if (!moves.empty()) hands.play(moves);
    return task.run(moves.empty() ? 0 : stepsIn(prefab::durationOf(moves) + 0.6), [&] {
        return text("score ", std::lround(score(task.progress())), ", ", judge.drops(), " dropped, ", judge.lost(),
                    " lost");
    });
}

std::vector<TrainerSetting> allSettings()
{
    std::vector<TrainerSetting> all;
    for (const auto& more : {laparoscopy::settingsOf("peg-transfer", kRules, kRings), operation::settings(),
                             cutting::settings(), ligating::settings(), suturing::settings(), cannulating::settings()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

} // namespace

int main(int argc, char** argv)
{
    const std::vector<std::string> cases = {"peg-transfer",  "cholecystectomy", "pattern-cutting",
                                            "ligating-loop", "suturing",        "cannulation"};
    std::vector<std::string> pictures;
    for (const std::string& each : cases) pictures.push_back(text("thumbnails/", each, ".png"));
    TrainerDef def{
        .name = "laparoscopy",
        .about = "A laparoscopy trainer: peg transfer, pattern cutting, a ligating loop, suturing and cannulation in a "
                 "box, and taking out a gall bladder.",
        .hands =
            "1, 2 and 3 choose the left hand, the right hand and the laparoscope. Drag with the right button to\n"
            "turn the chosen shaft; the wheel, W and S move it in and out, A and D roll it. The left button closes\n"
            "its jaws while it is held down, G closes and opens them. Page up and page down zoom.\n"
            "Cholecystectomy: 4, 5, 6, 7 and 8 give the right hand the hook (closing is its pedal), clips, scissors, "
            "the bag\nor suction (closing opens it; 9 rinses).\n"
            "Ligating loop: closing the right hand draws the thread, 4 lets the knot go.\n"
            "A haptic device (--device) holds the right handle, and a second one (--device NAME,NAME) the left; the\n"
            "first button closes the jaws.\n",
        .cases = cases,
        .difficulties = kDifficulties,
        .motions = {"expert", "clumsy"},
        .pictures = pictures,
        .window = {"Laparoscopy", 960, 720}};
    def.settings = allSettings();
    def.readCase = loadCase;
    return runTrainer(argc, argv, def, [&](const Training& training) {
        static constexpr std::array kTasks = {
            pegTransfer,        operation::cholecystectomy, cutting::patternCutting, ligating::ligatingLoop,
            suturing::suturing, cannulating::cannulation};
        const auto chosen = static_cast<std::size_t>(training.caseIndex);
        if (training.devices > 0 && kTasks[chosen] == operation::cholecystectomy)
            fail(cases[chosen], ": haptic devices hold handles in the other cases only");
        return kTasks[chosen](training);
    });
}
