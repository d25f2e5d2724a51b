#include "apps/laparoscopy/box.h"
#include "apps/laparoscopy/drain.h"

#include <atomic>
#include <utility>

using namespace filasofia;

namespace suturing {
namespace {

constexpr double kCutoff = 600.0; // [s] in the examination
using laparoscopy::Rules;
constexpr Rules kRules[] = {{true, kCutoff}, {false, kCutoff}, {false, 240.0}}; ///< by difficulty
/// What more a case file may change.
struct Limit {
    double deviation; ///< [m]
};
constexpr auto fields(const Limit*)
{
    return describe("Limit",
                    field("deviation", &Limit::deviation, "m", closed(0, 0.05), "from a mark: more is a mistake"));
}
constexpr Limit kLimits[] = {{3e-3}, {2e-3}, {1e-3}};           ///< by difficulty
constexpr double kTail = 45e-3;                                 // [m], thread that may be left before the way in
constexpr std::size_t kStitched = 4;                            // the step with which the trainee's part is done
constexpr double kClear = 60e-3;                                // [m] around the knot, for hands
constexpr double kLoad = 1.0, kSlips = 0.5e-3, kApart = 1.5e-3; // [N], [m]: the slit under load

/// Looks at the stitch, has the knot tied once it is drawn, and loads it.
class Judge {
public:
    Judge(Simulation& sim, const Drain& drain, std::array<const LaparoscopicInstrument*, 2> tools)
        : sim_(sim), drain_(drain), tools_(tools), knot_(sim, {.thread = drain.thread,
                                                               .place = transform(drain.pose, {0, 0.5_mm, 0}),
                                                               .across = rotate(drain.pose.orientation, {1, 0, 0}),
                                                               .force = 0.6,
                                                               .holding = 0.15,
                                                               .speed = 0.15})
    {
        sim.everyStep([this](double time) { watch(time); });
    }
    enum class Phase { Stitching, Clearing, Tying, Resting, Loaded, Over };

    [[nodiscard]] bool entered() const { return entered_; }
    [[nodiscard]] bool through() const { return through_; }
    [[nodiscard]] bool drawn() const { return phase_ != Phase::Stitching; }
    [[nodiscard]] bool clear() const { return drawn() && phase_ != Phase::Clearing; }
    [[nodiscard]] int throws() const { return knot_.tied(); }
    [[nodiscard]] bool over() const { return phase_ == Phase::Over; }
    [[nodiscard]] double deviation(Wall wall) const { return deviations_[wall]; }
    [[nodiscard]] double gap() const { return gap_; }
    [[nodiscard]] double gapAtRest() const { return atRest_; }
    [[nodiscard]] double loadedGap() const { return loaded_; }
    /// 0: secure, 1: it slips, 2: it comes apart, 3: not tried.
    [[nodiscard]] int insecurity() const
    {
        if (!over()) return 3;
        return loaded_ > kApart ? 2 : loaded_ > gap_ + kSlips ? 1 : 0;
    }

private:
    void watch(double time)
    {
        const FrameRef now = sim_.physics().latest();
        if (!now) return;
        const double gap = drain_.gap(*now);
        if (atRest_ == 0.0) atRest_ = gap;
        switch (phase_) {
        case Phase::Stitching: {
            const Stitch stitch = stitchOf(drain_, *now);
            for (const Wall wall : {LeftWall, RightWall}) deviations_[wall] = stitch.deviation[wall].value_or(0.0);
            entered_ = stitch.deviation[RightWall].has_value();
            through_ = entered_ && stitch.deviation[LeftWall];
            gap_ = gap;
            if (!stitch.threaded || stitch.tail > kTail) break;
            releaseThread(sim_, drain_); // the needle comes off, as a control-release needle does
            next(Phase::Clearing, time);
            break;
        }
        case Phase::Clearing:
            gap_ = gap;
            if (!std::ranges::all_of(tools_, [this](const auto* tool) { return isAway(*tool); })) break;
            knot_.begin();
            next(Phase::Tying, time);
            break;
        case Phase::Tying:
            gap_ = gap;
            if (!knot_.done()) break;
            knot_.release();
            next(Phase::Resting, time);
            break;
        case Phase::Resting:
            if (time < since_ + 0.5) break;
            gap_ = gap;
            load(sim_, drain_, kLoad);
            next(Phase::Loaded, time);
            break;
        case Phase::Loaded:
            loaded_ = gap;
            if (time > since_ + 1.0) next(Phase::Over, time);
            break;
        case Phase::Over:
            break;
        }
    }
    /// Whether no part of an instrument is in the way of the hands that tie.
    [[nodiscard]] bool isAway(const LaparoscopicInstrument& tool) const
    {
        const Vec3 from = transform(tool.report().pivot, {0, 0, -13_mm}), shaft = tool.def().trocar.fulcrum - from;
        const double part = std::clamp(dot(drain_.pose.position - from, shaft) / dot(shaft, shaft), 0.0, 1.0);
        return distance(from + part * shaft, drain_.pose.position) > kClear;
    }
    void next(Phase to, double time)
    {
        phase_ = to;
        since_ = time;
    }

    Simulation& sim_;
    const Drain& drain_;
    const std::array<const LaparoscopicInstrument*, 2> tools_;
    KnotHands knot_;
    std::atomic<Phase> phase_ = Phase::Stitching;
    double since_ = 0.0; ///< [s] in this phase
    std::atomic<bool> entered_ = false, through_ = false;
    std::array<std::atomic<double>, 2> deviations_ = {};
    std::atomic<double> atRest_ = 0.0, gap_ = 0.0, loaded_ = 0.0;
};

LaparoscopicInstrumentDef toolOf(laparoscopy::Side side, const Training& training)
{
    LaparoscopicInstrumentDef def = laparoscopy::instrumentOf(side, training);
    def.start.insertion -= 55_mm; // both wait in front of the drain
    def.name = side == laparoscopy::LeftSide ? "pick-ups" : "needle driver";
    def.tool.kind = side == laparoscopy::LeftSide ? InstrumentKind::PickUps : InstrumentKind::NeedleDriver;
    laparoscopy::useOwnJaws(def);
    return def;
}

} // namespace

std::vector<TrainerSetting> settings() { return laparoscopy::settingsOf("suturing", kRules, kLimits); }

int suturing(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const Limit limit = training.rules(kLimits[training.difficulty]);
    Simulation sim({.window = {"Suturing", 960, 720}, .look = {.mouse = false, .keys = false}});
    const auto seed = static_cast<std::uint64_t>(training.seed);
    const LaparoscopicInstrumentDef rightDef = toolOf(laparoscopy::RightSide, training);
    const Drain drain = addDrain(sim, rightDef.trocar, seed);
    LaparoscopicInstrument left(sim, toolOf(laparoscopy::LeftSide, training)), right(sim, rightDef);
    Laparoscope scope(sim, laparoscopy::scopeOf());
    TrocarHands hands(sim, left, right, scope, laparoscopy::handsOf(sim, left, right));
    Judge judge(sim, drain, {&left, &right});

    // In the manner of MISTELS (Derossis et al. 1998): the cutoff time less the time, less ten for each millimetre
    // beside a mark. The weight is ours. The knot does not count: it is not the trainee's.
    const auto score = [&](const TaskProgress& now) {
        if (now.doneAt.size() <= kStitched) return 0.0;
        return std::max(0.0, kCutoff - now.doneAt[kStitched] -
                                 1e4 * (judge.deviation(LeftWall) + judge.deviation(RightWall)));
    };
    const auto millimetres = [](double length) { return text(std::lround(1e4 * length) / 10.0, " mm"); };
    const auto way = [&](Wall wall, bool there) { return there ? millimetres(judge.deviation(wall)) : "none"; };
    TrainerTaskDef def{
        .steps =
            {laparoscopy::step("grasp", "Grasp the needle near its tail",
                               [&] { return right.tool().holding() == drain.needle; }),
             laparoscopy::step("in", "Turn it into the right mark", [&] { return judge.entered(); }),
             laparoscopy::step("out", "Turn it on, out at the left mark", [&] { return judge.through(); }),
             laparoscopy::step("draw", "Take it at its tip, turn it out, and draw the thread until its end is short",
                               [&] { return judge.drawn(); }),
             laparoscopy::step("clear", "The needle is off: withdraw both instruments", [&] { return judge.clear(); }),
             laparoscopy::step("knot", "Keep away: three throws are tied for you", [&] { return judge.throws() == 3; }),
             laparoscopy::step("load", "The closure is loaded", [&] { return judge.over(); })},
        .timeLimit = rules.timeLimit,
        .guided = rules.guided,
        .force = {.name = "Force on the drain",
                  .bodies = {drain.walls[LeftWall], drain.walls[RightWall]},
                  .warning = 1,
                  .full = 2},
        .done = "The slit is closed",
        .dress = [&](VisualServer& server) { scope.dress(server); },
        .results =
            [&](const TaskProgress& now) {
                static constexpr std::array kSecurity = {"secure", "slips", "comes apart", "not tied"};
                return std::vector<ResultLine>{
                    {"Time", text(std::lround(now.time), " s")},
                    {"Way in, from its mark", way(RightWall, judge.entered())},
                    {"Way out, from its mark", way(LeftWall, judge.through())},
                    {"Slit before, after", text(millimetres(judge.gapAtRest()), ", ", millimetres(judge.gap()))},
                    {"Slit under load", millimetres(judge.loadedGap())},
                    {"Knot", kSecurity[static_cast<std::size_t>(judge.insecurity())]},
                    {"Score", text(std::lround(score(now)), " of 600")}};
            },
        .score = score};
    def.observed.bodies = laparoscopy::observedIn(right, left, scope);
    def.observed.session = {.task = training.task("suturing"),
                            .fieldOfView = scope.def().fieldOfView,
                            .targets = {"right wall", "left wall"},
                            .watched = {EventKind::Mistake}};
    TrainerTask task(sim, training, def);
    sim.everyStep([&, told = false](double) mutable {
        if (!judge.drawn() || std::exchange(told, true)) return;
        for (const Wall wall : {LeftWall, RightWall})
            if (judge.deviation(wall) > limit.deviation)
                task.tracker().mark(EventKind::Mistake,
                                    wall == LeftWall ? "beside the left mark" : "beside the right mark");
    });
    const Motion with{sim,
                      drain,
                      left,
                      right,
                      scope,
                      [&] { return judge.drawn(); },
                      [&] { return judge.clear(); },
                      [&] { return judge.throws() == 3; },
                      [&](const char* name) { return task.picture(name); }};
    const int steps = laparoscopy::play(
        training, hands, [&] { return expertMotion(with); }, [&] { return clumsyMotion(with, seed); });
    return task.run(steps, [&] {
        return text("score ", std::lround(score(task.progress())), ", in ", way(RightWall, judge.entered()), ", out ",
                    way(LeftWall, judge.through()), ", gap ", millimetres(judge.gapAtRest()), " to ",
                    millimetres(judge.gap()), ", under load ", millimetres(judge.loadedGap()), ", ", judge.throws(),
                    " throws");
    });
}

} // namespace suturing
