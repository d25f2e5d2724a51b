#include "apps/laparoscopy/box.h"

#include "apps/laparoscopy/endoloop.h"
#include <filasofia/core/random.h>

#include <utility>

using namespace filasofia;

namespace ligating {
namespace {

constexpr double kCutoff = 180.0; // [s] in the published score
using laparoscopy::Rules;
constexpr Rules kRules[] = {{true, kCutoff}, {false, kCutoff}, {false, 53.0}}; ///< by difficulty
/// What more a case file may change.
struct Limit {
    double error; ///< [m]
};
constexpr auto fields(const Limit*)
{
    return describe("Limit", field("error", &Limit::error, "m", closed(0, 0.05),
                                   "by which the loop may be beside its mark: more is a mistake"));
}
constexpr Limit kLimits[] = {{3_mm}, {2_mm}, {1_mm}}; ///< by difficulty
constexpr double kNear = 5_mm;                        // to the mark, before it is drawn
constexpr double kTight = 0.10;                       // [-], narrowing of the appendage
constexpr double kAway = 20_mm;                       // the pusher's distance from the knot, once that is free
constexpr double kSettled = 1.0;                      // [s] after that
constexpr double kSlips = 1_mm;                       // what a secure loop moves at most, from the time it is let go
constexpr double kInsecure = 50.0;                    // points
constexpr Vec3 kGrip = {0, 0, -17_mm};

/// Looks at loop and appendage before every step.
class Judge {
public:
    Judge(Simulation& sim, const Foam& foam, const Endoloop& loop, const LaparoscopicInstrument& left,
          const LaparoscopicInstrument& pusher)
        : sim_(sim), foam_(foam), loop_(loop), left_(left), pusher_(pusher)
    {
        sim.everyStep([this](double time) { watch(time); });
    }
    [[nodiscard]] bool held() const { return around_ && left_.tool().holding() == foam_.target(); }
    [[nodiscard]] bool around() const { return around_; } ///< the loop goes around appendage or grasper
    [[nodiscard]] double error() const { return std::abs(place_ - kMark); } ///< [m], from the mark, if it goes around
    [[nodiscard]] bool near() const { return around_ && error() < kNear; }
    [[nodiscard]] double narrowing() const { return around_ ? narrowing_.load() : 0.0; }
    [[nodiscard]] bool tight() const { return narrowing() > kTight; }
    [[nodiscard]] bool isOver() const { return over_; } ///< the loop was let go, and has come to rest
    /// It goes around the appendage, holds it narrow and does not slip.
    [[nodiscard]] bool secure() const { return tight() && std::abs(place_ - letGoAt_) < kSlips; }

private:
    void watch(double time)
    {
        const FrameRef now = sim_.physics().latest();
        if (!now || over_) return;
        std::vector<Vec3> line = foam_.line(now);
        if (line.empty()) return;
        if (left_.tool().holding() == foam_.target()) // the loop may still be around the grasper
            line.insert(line.end(), {left_.tool().grip(), left_.report().pivot.position, left_.def().trocar.fulcrum});
        const auto place = placeAround(loop_.loop(now), line);
        around_ = place.has_value();
        if (place) place_ = *place;
        if (place) narrowing_ = foam_.narrowing(now, *place);
        if (!loop_.isFree()) letGoAt_ = place_;
        const bool away = loop_.isFree() && distance(pusher_.report().pivot.position, loop_.knot(now)) > kAway;
        if (!away) away_ = time;
        if (time - away_ > kSettled) over_ = true;
    }
    Simulation& sim_;
    const Foam& foam_;
    const Endoloop& loop_;
    const LaparoscopicInstrument &left_, &pusher_;
    double letGoAt_ = 0.0, away_ = 0.0;
    std::atomic<double> place_ = 0.0, narrowing_ = 0.0;
    std::atomic<bool> around_ = false, over_ = false;
};

const char* stateOf(const Judge& judge) { return judge.secure() ? "holds" : judge.around() ? "loose" : "off"; }
std::string millimetres(double length) { return text(std::round(1e4 * length) / 10.0, " mm"); }

struct Motion {
    Simulation& sim;
    const Foam& foam;
    Endoloop& loop;
    LaparoscopicInstrument &left, &right;
    Laparoscope& scope;
    std::function<std::function<void()>(const char*)> picture;
};

/// Puts the grasper's jaws, open across the appendage, at a place of it; `back` [m] is left along the shaft.
TrocarAim graspAt(const Motion& with, double place, double back)
{
    return [with, place, back] {
        const FrameRef now = with.sim.physics().latest();
        const Vec3 at = with.foam.at(now, place), along = with.foam.along(now, std::min(place, kLength - 3_mm));
        return reach(with.left, at, kGrip, cross(along, at - with.left.def().trocar.fulcrum), back);
    };
}

/// The pusher so that its loop lies around a place of the appendage, across it, with the mouth so far from its middle.
/// `still`: around that place at rest, wherever the pusher and the thread have drawn the appendage.
TrocarAim loopAt(const Motion& with, double place, double ahead, Vec3 off = {}, bool still = false)
{
    return [with, place, ahead, off, still] {
        const FrameRef now = with.sim.physics().latest();
        const Vec3 along = with.foam.along(now, std::min(place, kLength - 3_mm));
        Vec3 at = (still ? transform(with.foam.poses[1], {0, place, 0}) : with.foam.at(now, place)) + off;
        // The loop is not exactly where the pusher points to.
        if (const auto is = placeAround(with.loop.loop(now), with.foam.line(now)); is && *is < kLength)
            at += std::clamp(place - *is, -1.0_mm, 1.0_mm) * along;
        return reach(with.right, at, {0, 0, -ahead}, along);
    };
}

auto pull(const Motion& with, bool on)
{
    return [&tool = with.right.tool(), on] { return on ? tool.close() : tool.open(); };
}

TrocarPlan expertMotion(const Motion& with)
{
    TrocarPlan plan(with.left, with.right, with.scope);
    // [m] From the mouth to the middle of the open loop; the grip; the knot comes up a little as the pusher goes.
    constexpr double kOpen = 19_mm, kTip = kLength - 5_mm, kAim = kMark - 0.3_mm;
    plan.rest(0.4); // foam and loop come to rest
    plan.add(1.2, {}, loopAt(with, kLength + 12_mm, kOpen)).begin = [&left = with.left] { left.tool().open(0.5); };
    plan.add(0.6, {}, loopAt(with, kLength + 3_mm, kOpen));
    plan.add(0.6, {}, loopAt(with, kLength - 14_mm, kOpen));
    plan.add(1.0, graspAt(with, kTip, 30_mm), {});
    plan.add(0.6, graspAt(with, kTip, 0.0), {});
    plan.rest(0.6).begin = [&left = with.left] { left.tool().close(); };
    plan.rest(0.1).end = with.picture("held");
    for (int i = 1; i <= 10; ++i)
        plan.add(0.15, {}, loopAt(with, kLength - 14_mm + i * (kMark - kLength + 14_mm) / 10, kOpen - 0.4_mm * i));
    plan.rest(0.1).end = with.picture("placed");
    constexpr int kParts = 24;
    for (int i = 0; i < kParts; ++i) { // drawn, and pushed after it
        TrocarMove& move =
            plan.add(0.15, {}, loopAt(with, kAim, 15_mm - i * (15_mm - kRadius - 1_mm) / (kParts - 1), {}, true));
        if (i == 0) move.begin = pull(with, true);
        if (i == kParts / 2) move.end = with.picture("drawn");
    }
    for (int i = 0; i < 4; ++i) plan.add(0.2, {}, loopAt(with, kAim, kRadius + 0.5_mm, {}, true));
    plan.rest(0.3).end = with.picture("tight");
    plan.rest(0.2).begin = [&loop = with.loop] { loop.letGo(); };
    plan.rest(0.4).begin = [&left = with.left] { left.tool().open(0.5); };
    const auto back = [with] {
        TrocarPose pose = with.right.report().pose;
        pose.insertion -= 35_mm;
        return pose;
    };
    plan.add(1.0, graspAt(with, kTip, 25_mm), back).end = with.picture("free");
    plan.rest(1.2);
    return plan;
}

/// Lowers the loop more or less over the foam, snaps at tips, draws the thread now and then, and lets it go.
TrocarPlan clumsyMotion(const Motion& with, std::uint64_t seed)
{
    Random random(seed);
    TrocarPlan plan(with.left, with.right, with.scope);
    plan.rest(0.4);
    for (int i = 0; i < 5; ++i) {
        const Vec3 off = {random.between(-12_mm, 12_mm), random.between(-3_mm, 8_mm), random.between(-8_mm, 8_mm)};
        const double down = random.between(0.0, kLength), draws = random.between(0.5, 2.5);
        plan.add(random.between(0.3, 0.8), {}, loopAt(with, kLength + 8_mm, 18_mm, off));
        plan.add(random.between(0.3, 0.8), {},
                 loopAt(with, down, random.between(8_mm, 18_mm), i % 2 == 0 ? Vec3{} : off));
        if (random.onceIn(2)) {
            const double place = random.between(0.5 * kLength, kLength);
            plan.add(random.between(0.3, 0.6), graspAt(with, place, 25_mm), {}).begin = [&left = with.left] {
                left.tool().open(0.6);
            };
            plan.add(random.between(0.2, 0.5), graspAt(with, place, random.between(-3_mm, 4_mm)), {});
            plan.rest(0.3).begin = [&left = with.left] { left.tool().close(); };
        }
        if (random.onceIn(2)) {
            plan.rest(draws).begin = pull(with, true);
            plan.rest(0.1).begin = pull(with, false);
        }
    }
    if (random.onceIn(2)) plan.rest(0.2).begin = [&loop = with.loop] { loop.letGo(); };
    plan.add(0.6, {}, [with] { return with.right.def().start; });
    plan.rest(1.2);
    return plan;
}

} // namespace

std::vector<TrainerSetting> settings() { return laparoscopy::settingsOf("ligating-loop", kRules, kLimits); }

int ligatingLoop(const Training& training)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const Limit limit = training.rules(kLimits[training.difficulty]);
    const auto seed = static_cast<std::uint64_t>(training.seed);
    Simulation sim({.window = {"Ligating loop", 960, 720}, .look = {.mouse = false, .keys = false}});
    const Foam foam = addFoam(sim, seed);
    LaparoscopicInstrumentDef leftDef = laparoscopy::instrumentOf(laparoscopy::LeftSide, training);
    leftDef.tool.groups = {LeftTool};
    leftDef.tool.gripStiffness = 200.0;
    leftDef.start.insertion -= 50_mm;
    LaparoscopicInstrument left(sim, leftDef), right(sim, pusherOf(training));
    Laparoscope scope(sim, laparoscopy::scopeOf());
    TrocarHands hands(sim, left, right, scope, laparoscopy::handsOf(sim, left, right));
    Endoloop loop(sim, right);
    Judge judge(sim, foam, loop, left, right);
    sim.on<KeyEvent>([&](const KeyEvent& e) {
        if (e.pressed && e.key == KeyCode::Digit4) loop.letGo();
    });

    // The cutoff time less the time, less a penalty for the distance from the mark and for a loop that is not secure.
    const auto score = [&](const TaskProgress& now) {
        if (now.state != TaskProgress::State::Done) return 0.0;
        return std::max(0.0, kCutoff - now.time - 1e3 * judge.error() - (judge.secure() ? 0.0 : kInsecure));
    };
    TrainerTaskDef def{
        .steps = {laparoscopy::step("hold",
                                    "Put the loop over the middle appendage, and grasp its tip through the loop",
                                    [&] { return judge.held(); }),
                  laparoscopy::step("place", "Bring the loop down to the mark", [&] { return judge.near(); }),
                  laparoscopy::step("tight",
                                    "Close the pusher's handle to draw the thread, and keep the loop at the mark",
                                    [&] { return judge.tight(); }),
                  laparoscopy::step("let go", "4: let the knot go, and draw the pusher back",
                                    [&] { return judge.isOver() && judge.around(); })},
        .timeLimit = rules.timeLimit,
        .guided = rules.guided,
        .force = {.name = "Force of the instruments", .bodies = {left.body(), right.body()}, .warning = 2, .full = 4},
        .done = "The appendage is tied off",
        .dress = [&](VisualServer& server) { scope.dress(server); },
        .results =
            [&](const TaskProgress& now) {
                return std::vector<ResultLine>{{"Time", text(std::lround(now.time), " s")},
                                               {"From the mark", judge.around() ? millimetres(judge.error()) : "-"},
                                               {"Narrower by", text(std::lround(100 * judge.narrowing()), " %")},
                                               {"Loop", stateOf(judge)},
                                               {"Score", text(std::lround(score(now)), " of 180")}};
            },
        .score = score};
    def.observed.bodies = laparoscopy::observedIn(right, left, scope);
    def.observed.session = {.task = training.task("ligating loop"),
                            .fieldOfView = scope.def().fieldOfView,
                            .watched = {EventKind::Mistake}};
    TrainerTask task(sim, training, def);
    sim.everyStep([&, told = false](double) mutable {
        if (!judge.isOver() || std::exchange(told, true)) return;
        if (!judge.around()) return task.tracker().mark(EventKind::Mistake, "loop off the appendage");
        task.tracker().mark(EventKind::Note, text(millimetres(judge.error()), " from the mark"));
        if (judge.error() > limit.error) task.tracker().mark(EventKind::Mistake, "beside the mark");
        if (!judge.secure()) task.tracker().mark(EventKind::Mistake, "loop not secure");
    });

    const Motion with{sim, foam, loop, left, right, scope, [&](const char* name) { return task.picture(name); }};
    const int steps = laparoscopy::play(
        training, hands, [&] { return expertMotion(with); }, [&] { return clumsyMotion(with, seed); });
    return task.run(steps, [&] {
        const auto end = text("score ", std::lround(score(task.progress())), ", loop ", stateOf(judge));
        if (!judge.around()) return end;
        return text(end, ", ", millimetres(judge.error()), " from the mark, narrower by ",
                    std::lround(100 * judge.narrowing()), " %");
    });
}

} // namespace ligating
