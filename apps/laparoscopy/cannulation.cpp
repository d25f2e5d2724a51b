#include "apps/laparoscopy/box.h"
#include "apps/laparoscopy/duct.h"

#include <filasofia/core/random.h>

#include <atomic>
#include <utility>

using namespace filasofia;

namespace cannulating {
namespace {

constexpr double kCutoff = 180.0; // [s]
using laparoscopy::Rules;
constexpr Rules kRules[] = {{true, kCutoff}, {false, kCutoff}, {false, 60.0}}; ///< by difficulty
/// What more a case file may change.
struct Limit {
    double force; ///< [N]
};
constexpr auto fields(const Limit*)
{
    return describe("Limit", field("force", &Limit::force, "N", closed(0.01, 100), "on the duct: more is a mistake"));
}
constexpr Limit kLimits[] = {{1.0}, {0.5}, {0.2}}; ///< by difficulty
constexpr double kBeside = 4.5_mm;                 // from the opening: a tip that touches the duct there has missed
constexpr double kApart = 0.3;                     // [s] between two misses
constexpr double kSettled = 1.0;                   // [s] after the catheter was let go
constexpr Vec3 kGrip = {0, 0, -17_mm};
constexpr double kOpen = 0.25; // [-], the jaws' opening

/// Looks at catheter and duct before every step.
class Judge {
public:
    Judge(Simulation& sim, const Duct& duct, std::array<const LaparoscopicInstrument*, 2> tools)
        : sim_(sim), duct_(duct), tools_(tools)
    {
        sim.everyStep([this](double time) { watch(time); });
    }
    std::function<void(const std::string&)> mistake; ///< called for what is recorded

    [[nodiscard]] bool held() const { return held_; }
    [[nodiscard]] bool entered() const { return entered_; }
    [[nodiscard]] double depth() const { return depth_; } ///< [m]
    [[nodiscard]] bool placed() const { return depth_ >= kMarks[0]; }
    /// Between its marks, let go, and at rest.
    [[nodiscard]] bool over() const { return over_; }
    [[nodiscard]] int tries() const { return tries_; }   ///< how often the tip has entered the duct
    [[nodiscard]] int misses() const { return misses_; } ///< how often it has touched the duct elsewhere

private:
    void watch(double time)
    {
        const FrameRef now = sim_.physics().latest();
        if (!now || now->softBody(duct_.wall) == nullptr || over_) return;
        held_ = std::ranges::any_of(tools_, [this](auto* tool) { return tool->tool().holding() == duct_.catheter; });
        const bool was = inside_;
        inside_ = duct_.place(*now, duct_.tip(*now)).away < (was ? kOutside : kLumen - kCatheter);
        depth_ = duct_.depth(*now);
        entered_ = inside_;
        if (inside_ && !was) ++tries_;
        if (was && !inside_) mistake("the tip came out");
        if (!inside_ && touches(*now)) {
            if (time - touched_ > kApart) {
                ++misses_;
                mistake("the tip missed the opening");
            }
            touched_ = time;
        }
        if (depth_ > kMarks[1] && !std::exchange(deep_, true)) mistake("too deep");
        if (depth_ <= kMarks[1]) deep_ = false;
        if (held_ || !placed() || deep_) letGo_ = time;
        if (time - letGo_ > kSettled) over_ = true;
    }
    /// Whether the tip touches the duct beside the opening.
    [[nodiscard]] bool touches(const frame::Frame& now) const
    {
        const Vec3 tip = duct_.tip(now), opening = transform(duct_.pose, {0, kLumen + kWall, 0});
        if (distance(tip, opening) < kBeside) return false;
        return std::ranges::any_of(now.contacts, [&](const frame::Contact& each) {
            return each.normalForce > 0.0 &&
                   std::minmax(each.first, each.second) == std::minmax(duct_.wall, duct_.catheter) &&
                   distance(each.point, tip) < 2.0 * kCatheter;
        });
    }
    Simulation& sim_;
    const Duct& duct_;
    const std::array<const LaparoscopicInstrument*, 2> tools_;
    bool inside_ = false, deep_ = false;
    double touched_ = -kApart, letGo_ = 0.0; ///< [s]
    std::atomic<bool> held_ = false, entered_ = false, over_ = false;
    std::atomic<double> depth_ = 0.0;
    std::atomic<int> tries_ = 0, misses_ = 0;
};

struct Motion {
    Simulation& sim;
    const Duct& duct;
    LaparoscopicInstrument &left, &right;
    Laparoscope& scope;
    std::function<double()> depth;
    std::function<std::function<void()>(const char*)> picture;

    [[nodiscard]] Vec3 opening() const { return transform(duct.pose, {0, kLumen, 0}); }
};

/// The jaws, open across the catheter, so far behind its tip; `back` [m] is left along the shaft.
TrocarAim atCatheter(const Motion& with, double behind, double back, Vec3 off = {})
{
    return [with, behind, back, off] {
        const FrameRef now = with.sim.physics().latest();
        const Vec3 at = with.duct.at(*now, behind) + off;
        return reach(with.right, at, kGrip,
                     cross(with.duct.forward(*now, behind), at - with.right.def().trocar.fulcrum), back);
    };
}

/// The held catheter with its tip at a place in the duct's coordinates.
TrocarAim tipAt(const Motion& with, Vec3 place)
{
    return [with, place] {
        const TrocarReport report = with.right.report();
        const Vec3 tip = transform(inverse(report.pivot), with.duct.tip(*with.sim.physics().latest()));
        return poseAt(with.right.def().trocar, transform(with.duct.pose, place), report.pose.roll, tip);
    };
}

/// The right hand from where it is, in the duct's coordinates.
TrocarAim onwards(const Motion& with, Vec3 by)
{
    return [with, by] {
        const TrocarReport report = with.right.report();
        const Vec3 grip = transform(report.pivot, kGrip) + rotate(with.duct.pose.orientation, by);
        return poseAt(with.right.def().trocar, grip, report.pose.roll, kGrip);
    };
}

void addTake(const Motion& with, TrocarPlan& plan, double behind, Vec3 off = {})
{
    plan.add(0.8, {}, atCatheter(with, behind, 25_mm, off)).begin = [&right = with.right] { right.tool().open(kOpen); };
    plan.add(0.6, {}, atCatheter(with, behind, 0.0, off));
    plan.rest(0.5).begin = [&right = with.right] { right.tool().close(); };
}
void addLetGo(const Motion& with, TrocarPlan& plan)
{
    plan.rest(0.3).begin = [&right = with.right] { right.tool().open(kOpen); };
    plan.add(0.5, {}, [&right = with.right] {
        TrocarPose pose = right.report().pose;
        pose.insertion -= 25_mm;
        return pose;
    });
}

/// Feeds the held catheter along its line to the opening, until it is deep enough or the jaws are near.
void addFeed(const Motion& with, TrocarPlan& plan, double depth)
{
    constexpr double kStep = 1_mm, kNear = 15_mm;
    for (int i = 0; i < 16; ++i) {
        const auto by = [with] {
            const Vec3 grip = transform(with.right.report().pivot, kGrip);
            return transform(inverse(with.duct.pose), with.opening()) - transform(inverse(with.duct.pose), grip);
        };
        plan.add(0.1, {}, [with, by] { return onwards(with, kStep * normalized(by()))(); }).skip = [with, by, depth] {
            return with.depth() >= depth || length(by()) < kNear;
        };
    }
}

TrocarPlan expertMotion(const Motion& with)
{
    TrocarPlan plan(with.left, with.right, with.scope);
    constexpr double kGoal = 17_mm;
    plan.rest(0.4); // duct and catheter come to rest
    addTake(with, plan, 24_mm);
    plan.rest(0.1).end = with.picture("held");
    plan.add(0.8, {}, tipAt(with, {-10_mm, kLumen + 6_mm, 0}));
    plan.add(0.4, {}, tipAt(with, {-4_mm, kLumen + 2.5_mm, 0}));
    for (int i = 0; i < 4; ++i) plan.add(0.2, {}, tipAt(with, {-3_mm + i * 1.5_mm, kLumen + 1.5_mm - i * 1_mm, 0}));
    plan.rest(0.1).end = with.picture("entered");
    addFeed(with, plan, kGoal);
    for (int i = 0; i < 2; ++i) {
        addLetGo(with, plan);
        if (i == 1) plan.rest(0.1).end = with.picture("free");
        addTake(with, plan, 34_mm);
        addFeed(with, plan, kGoal);
        if (i == 0) plan.rest(0.1).end = with.picture("advanced");
    }
    addLetGo(with, plan);
    plan.rest(1.2);
    return plan;
}

/// Snaps at the catheter more or less where it is, pushes it somewhere near the opening, and lets it go.
TrocarPlan clumsyMotion(const Motion& with, std::uint64_t seed)
{
    Random random(seed);
    TrocarPlan plan(with.left, with.right, with.scope);
    plan.rest(0.4);
    const auto some = [&](double most) { return random.between(-most, most); };
    for (int i = 0; i < 4; ++i) {
        const double behind = random.between(3_mm, 25_mm);
        const Vec3 off{some(2_mm), some(2_mm), some(2_mm)};
        addTake(with, plan, behind, off);
        for (int k = 0; k < 4; ++k) {
            const Vec3 place{some(10_mm), kLumen + some(5_mm), some(5_mm)};
            plan.add(random.between(0.2, 0.6), {}, tipAt(with, place));
        }
        const Vec3 away{some(20_mm), random.between(0.0, 20_mm), some(10_mm)};
        plan.add(random.between(0.2, 0.6), {}, onwards(with, away));
        if (!random.onceIn(3)) addLetGo(with, plan);
    }
    return plan;
}

LaparoscopicInstrumentDef toolOf(laparoscopy::Side side, const Training& training)
{
    LaparoscopicInstrumentDef def = laparoscopy::instrumentOf(side, training);
    def.start.insertion -= side == laparoscopy::LeftSide ? 10_mm : 50_mm; // both wait in front of the duct
    laparoscopy::useOwnJaws(def);
    return def;
}

} // namespace

std::vector<TrainerSetting> settings() { return laparoscopy::settingsOf("cannulation", kRules, kLimits); }

int cannulation(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const Limit limit = training.rules(kLimits[training.difficulty]);
    Simulation sim({.window = {"Cannulation", 960, 720}, .look = {.mouse = false, .keys = false}});
    const auto seed = static_cast<std::uint64_t>(training.seed);
    const Duct duct = addDuct(sim, seed);
    LaparoscopicInstrument left(sim, toolOf(laparoscopy::LeftSide, training)),
        right(sim, toolOf(laparoscopy::RightSide, training));
    Laparoscope scope(sim, laparoscopy::scopeOf());
    scope.zoom(1.4);
    TrocarHands hands(sim, left, right, scope, laparoscopy::handsOf(sim, left, right));
    Judge judge(sim, duct, {&left, &right});

    // Ours: the cutoff time less the time, less ten for each miss and each time that the tip came out.
    const auto score = [&](const TaskProgress& now) {
        if (now.state != TaskProgress::State::Done) return 0.0;
        return std::max(0.0, kCutoff - now.time - 10.0 * (judge.misses() + judge.tries() - 1));
    };
    const auto millimetres = [](double length) { return text(std::lround(1e4 * length) / 10.0, " mm"); };
    TrainerTaskDef def{
        .steps = {laparoscopy::step("grasp", "Grasp the catheter near its tip", [&] { return judge.held(); }),
                  laparoscopy::step("enter", "Lead its tip into the opening", [&] { return judge.entered(); }),
                  laparoscopy::step("advance", "Advance it until the first mark is in the duct, and the second is not",
                                    [&] { return judge.placed() && judge.depth() <= kMarks[1]; }),
                  laparoscopy::step("let go", "Let it go: it has to stay", [&] { return judge.over(); })},
        .timeLimit = rules.timeLimit,
        .guided = rules.guided,
        .force = {.name = "Force on the duct", .bodies = {duct.wall}, .warning = 0.5, .full = 1},
        .done = "The catheter is in the duct",
        .dress = [&](VisualServer& server) { scope.dress(server); },
        .results =
            [&](const TaskProgress& now) {
                return std::vector<ResultLine>{{"Time", text(std::lround(now.time), " s")},
                                               {"Depth", millimetres(judge.depth())},
                                               {"Tries", text(judge.tries())},
                                               {"Misses", text(judge.misses())},
                                               {"Score", text(std::lround(score(now)), " of 180")}};
            },
        .score = score};
    def.observed.bodies = laparoscopy::observedIn(right, left, scope);
    def.observed.session = {
        .task = training.task("cannulation"), .fieldOfView = scope.def().fieldOfView, .watched = {EventKind::Mistake}};
    TrainerTask task(sim, training, def);
    sim.on<TearEvent>([&, told = false](const TearEvent&) mutable {
        if (!std::exchange(told, true)) task.tracker().mark(EventKind::Mistake, "the duct tore");
    });
    judge.mistake = [&](const std::string& what) { task.tracker().mark(EventKind::Mistake, what); };
    sim.everyStep([&, told = false](double) mutable {
        if (task.force().highest() <= limit.force || std::exchange(told, true)) return;
        judge.mistake("the duct was pressed");
    });

    const Motion with{sim,
                      duct,
                      left,
                      right,
                      scope,
                      [&] { return judge.depth(); },
                      [&](const char* name) { return task.picture(name); }};
    const int steps = laparoscopy::play(
        training, hands, [&] { return expertMotion(with); }, [&] { return clumsyMotion(with, seed); });
    return task.run(steps, [&] {
        return text("score ", std::lround(score(task.progress())), ", ", millimetres(judge.depth()), " deep, ",
                    judge.tries(), " tries, ", judge.misses(), " misses");
    });
}

} // namespace cannulating
