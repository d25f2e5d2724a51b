#include "apps/laparoscopy/box.h"

#include "apps/laparoscopy/gauze.h"
#include <filasofia/core/random.h>

#include <numbers>
#include <utility>

using namespace filasofia;

namespace cutting {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCutoff = 300.0; // [s] in the published score
using laparoscopy::Rules;
constexpr Rules kRules[] = {{true, kCutoff}, {false, kCutoff}, {false, 120.0}}; ///< by difficulty
/// What more a case file may change.
struct Limit {
    double deviation; ///< [-]
};
constexpr auto fields(const Limit*)
{
    return describe("Limit", field("deviation", &Limit::deviation, "-", closed(0, 1),
                                   "over the area of the disc: more is a mistake"));
}
constexpr Limit kLimits[] = {{0.15}, {0.08}, {0.04}};           ///< by difficulty
constexpr Vec3 kGrip = {0, 0, -17_mm}, kBlade = {0, 0, -12_mm}; // from the pivots

/// Looks at the gauze whenever it was cut.
class Judge {
public:
    Judge(Simulation& sim, const Gauze& gauze) : sim_(sim), gauze_(gauze)
    {
        sim.everyStep([this](double) { watch(); });
    }
    [[nodiscard]] double around() const { return around_; }
    [[nodiscard]] bool out() const { return out_; }
    [[nodiscard]] double deviation() const { return deviation_ / (kPi * kRadius * kRadius); } ///< [-] over the disc

private:
    void watch()
    {
        const FrameRef now = sim_.physics().latest();
        const frame::SoftBodyFrame* body = now ? now->softBody(gauze_.body) : nullptr;
        if (body == nullptr || !body->boundary || out_) return;
        if (std::exchange(revision_, body->boundary->revision) == body->boundary->revision) return;
        const CutPattern found = patternOf(gauze_, *body);
        around_ = found.around;
        deviation_ = found.deviation;
        out_ = found.out;
    }
    Simulation& sim_;
    const Gauze& gauze_;
    std::uint64_t revision_ = 0;
    std::atomic<double> around_ = 0.0, deviation_ = 0.0;
    std::atomic<bool> out_ = false;
};

LaparoscopicInstrumentDef toolOf(laparoscopy::Side side, const Training& training)
{
    LaparoscopicInstrumentDef def = laparoscopy::instrumentOf(side, training);
    def.start.insertion -= 65_mm; // both wait in front of the gauze
    if (side == laparoscopy::LeftSide) {
        def.tool.groups = {LeftTool};
        def.tool.gripStiffness = 400.0;
        return def;
    }
    def.name = "scissors";
    def.tool.kind = InstrumentKind::LaparoscopicScissors;
    def.tool.groups = {RightTool};
    def.tool.opening = 0.6;
    def.tool.shaftCollision = shapes::box({1_mm, 1_mm, 1_mm}); // the gauze must not hang on the shaft
    // One edge cuts: two that are 0.4 mm apart leave slivers.
    for (const bool upper : {true, false}) {
        prefab::JawDef jaw{.axis = {upper ? 1.0 : -1.0, 0, 0}, .opensBy = 35_deg};
        jaw.surface = asset(text("meshes/laparoscopy/scissors_blade_", upper ? "upper" : "lower", ".obj"));
        if (upper) jaw.edge = std::array{Vec3{0, 0, -3_mm}, Vec3{0, 0, -19.2_mm}};
        def.tool.jaws.push_back(jaw);
    }
    return def;
}

struct Motion {
    Simulation& sim;
    const Gauze& gauze;
    LaparoscopicInstrument &left, &right;
    Laparoscope& scope;
    std::function<std::function<void()>(const char*)> picture;
    std::function<bool()> done; ///< the circle is out
};

/// A point of an instrument at a point of the gauze, which passes between its jaws; `back` [m] is left along the shaft.
TrocarAim toGauze(const Motion& with, const LaparoscopicInstrument& tool, Vec3 point, std::array<double, 2> place,
                  double back)
{
    return [with, &tool, point, place, back] {
        const FrameRef now = with.sim.physics().latest();
        const auto [x, z] = place;
        return reach(tool, with.gauze.at(now, x, z), point, with.gauze.normalAt(now, x, z), back);
    };
}
TrocarAim bladesAt(const Motion& with, double x, double z, double back = 0.0)
{
    return toGauze(with, with.right, kBlade, {x, z}, back);
}
TrocarAim jawsAt(const Motion& with, double x, double z, double back)
{
    return toGauze(with, with.left, kGrip, {x, z}, back);
}

/// Takes the free corner, and draws it tight.
void addHold(const Motion& with, TrocarPlan& plan)
{
    constexpr double kAt = 0.5 * kSide - 4_mm;
    plan.rest(1.0); // the gauze comes to rest
    plan.add(0.8, jawsAt(with, -kAt, kAt, 30_mm), {}).begin = [&left = with.left] { left.tool().open(0.5); };
    plan.add(0.6, jawsAt(with, -kAt, kAt, 0.0), {});
    plan.rest(0.5).begin = [&left = with.left] { left.tool().close(); };
    plan.rest(0.1).end = with.picture("held");
    const auto tight = [with] {
        const Vec3 to = transform(with.gauze.pose, {-kAt - 2_mm, 1_mm, kAt + 2_mm});
        return poseAt(with.left.def().trocar, to, with.left.report().pose.roll, kGrip);
    };
    plan.add(0.7, tight, {}).end = with.picture("taut");
}

TrocarPlan expertMotion(const Motion& with)
{
    TrocarPlan plan(with.left, with.right, with.scope);
    addHold(with, plan);
    const double step = 2.0_mm, speed = 12_mm; // [m/s]
    const int parts = static_cast<int>(2.0 * kPi * kRadius / step);
    const auto onCircle = [&](int i, double back = 0.0) {
        const double angle = 2.0 * kPi * i / parts;
        return bladesAt(with, kRadius * std::sin(angle), kRadius * std::cos(angle), back);
    };
    // The closed blades pierce the gauze in front, and go round. A cut that came from the edge would meet itself there.
    plan.add(0.8, {}, onCircle(0, 32_mm)).begin = [&right = with.right] { right.tool().close(); };
    plan.add(0.5, {}, onCircle(0));
    for (int i = 1; i < parts + 12; ++i) { // on over its start, where something may still hold
        TrocarMove& move = plan.add(step / speed, {}, onCircle(i));
        if (i > parts) move.skip = with.done;
        if (i == parts / 2) move.end = with.picture("half");
        if (i == 7 * parts / 8) move.end = with.picture("nearly");
    }
    plan.rest(0.3);
    plan.add(0.6, {}, [with] { return with.right.def().start; });
    return plan;
}

/// Snips here and there, and pulls.
TrocarPlan clumsyMotion(const Motion& with, std::uint64_t seed)
{
    Random random(seed);
    TrocarPlan plan(with.left, with.right, with.scope);
    addHold(with, plan);
    for (int i = 0; i < 8; ++i) {
        double x = random.between(-40_mm, 40_mm), z = random.between(-40_mm, 60_mm);
        const double height = random.between(15_mm, 40_mm);
        plan.add(random.between(0.3, 0.7), {}, bladesAt(with, x, z, height)).begin = [&right = with.right] {
            right.tool().open(0.6);
        };
        plan.add(random.between(0.2, 0.5), {}, bladesAt(with, x, z));
        const int strokes = 1 + random.below(4);
        for (int k = 0; k < strokes; ++k) {
            x += random.between(-15_mm, 15_mm), z += random.between(-15_mm, 15_mm);
            const double above = random.between(-6_mm, 3_mm);
            TrocarMove& move = plan.add(random.between(0.2, 0.8), {}, bladesAt(with, x, z, above));
            if (random.onceIn(2)) move.begin = [&right = with.right] { right.tool().close(); };
        }
        if (!random.onceIn(3)) continue;
        const Vec3 pull = {random.between(-20_mm, 10_mm), random.between(-10_mm, 25_mm), random.between(-10_mm, 20_mm)};
        plan.add(random.between(0.3, 0.8),
                 [with, pull] {
                     const Vec3 grip = transform(with.left.report().pivot, kGrip);
                     return poseAt(with.left.def().trocar, grip + pull, with.left.report().pose.roll, kGrip);
                 },
                 {});
        if (random.onceIn(2)) plan.rest(0.2).begin = [&left = with.left] { left.tool().open(0.5); };
    }
    return plan;
}

} // namespace

std::vector<TrainerSetting> settings() { return laparoscopy::settingsOf("pattern-cutting", kRules, kLimits); }

int patternCutting(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const Limit limit = training.rules(kLimits[training.difficulty]);
    Simulation sim({.window = {"Pattern cutting", 960, 720}, .look = {.mouse = false, .keys = false}});
    const auto seed = static_cast<std::uint64_t>(training.seed);
    const Gauze gauze = addGauze(sim, seed);
    LaparoscopicInstrument left(sim, toolOf(laparoscopy::LeftSide, training)),
        right(sim, toolOf(laparoscopy::RightSide, training));
    Laparoscope scope(sim, laparoscopy::scopeOf());
    TrocarHands hands(sim, left, right, scope, laparoscopy::handsOf(sim, left, right));
    Judge judge(sim, gauze);

    // MISTELS (Derossis et al. 1998): the cutoff time less the time, less the area of deviation in percent.
    const auto score = [&](const TaskProgress& now) {
        return now.state == TaskProgress::State::Done ? std::max(0.0, kCutoff - now.time - 100.0 * judge.deviation())
                                                      : 0.0;
    };
    TrainerTaskDef def{
        .steps = {laparoscopy::step("hold", "Grasp the free corner with the left hand, and draw the gauze tight",
                                    [&] { return left.tool().holding() == gauze.body; }),
                  laparoscopy::step("begin",
                                    "Pierce the gauze at the circle with the scissors, or cut there from the edge",
                                    [&] { return judge.around() > 0.0; }),
                  laparoscopy::step("half", "Cut along the circle, between the two lines",
                                    [&] { return judge.around() > 0.5; }),
                  laparoscopy::step("out", "Cut the circle out", [&] { return judge.out(); })},
        .timeLimit = rules.timeLimit,
        .guided = rules.guided,
        .force = {.name = "Force of the grasper", .bodies = {left.body()}, .warning = 3, .full = 6},
        .done = "The circle is cut out",
        .dress = [&](VisualServer& server) { scope.dress(server); },
        .results =
            [&](const TaskProgress& now) {
                return std::vector<ResultLine>{
                    {"Time", text(std::lround(now.time), " s")},
                    {"Deviation", text(std::lround(100 * judge.deviation()), " % of the disc")},
                    {"Score", text(std::lround(score(now)), " of 300")}};
            },
        .score = score};
    def.observed.bodies = laparoscopy::observedIn(right, left, scope);
    def.observed.session = {.task = training.task("pattern cutting"),
                            .fieldOfView = scope.def().fieldOfView,
                            .targets = {"gauze"},
                            .watched = {EventKind::Mistake}};
    TrainerTask task(sim, training, def);
    sim.everyStep([&, told = false](double) mutable {
        if (!judge.out() || std::exchange(told, true)) return;
        task.tracker().mark(EventKind::Residual, "deviation from the circle", judge.deviation());
        if (judge.deviation() > limit.deviation) task.tracker().mark(EventKind::Mistake, "beside the circle");
    });

    const Motion with{sim,
                      gauze,
                      left,
                      right,
                      scope,
                      [&](const char* name) { return task.picture(name); },
                      [&] { return judge.out(); }};
    const int steps = laparoscopy::play(
        training, hands, [&] { return expertMotion(with); }, [&] { return clumsyMotion(with, seed); });
    return task.run(steps, [&] {
        return text("score ", std::lround(score(task.progress())), ", ", std::lround(100 * judge.around()),
                    " % of the circle cut, deviation ", std::lround(1000 * judge.deviation()) / 10.0, " %");
    });
}

} // namespace cutting
