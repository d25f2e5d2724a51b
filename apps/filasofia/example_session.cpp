#include "apps/filasofia/report.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace filasofia::app {
namespace {

using metric::EventKind;

constexpr double kRate = 200.0; // [Hz]

/// A hand with a skill between 0 (first day) and 1 (expert). It makes minimum-jerk reaches, in as many pieces as it
/// needs, with pauses, detours, tremor, and forces that are larger than they should be.
class Hand {
public:
    Hand(double skill, unsigned seed) : clumsy_(1.0 - skill), random_(seed) {}

    void reach(Vec3 to)
    {
        const int pieces = 1 + static_cast<int>(std::lround(clumsy_ * 4.0 * uniform()));
        const Vec3 from = place_, way = to - from;
        for (int i = 1; i <= pieces; ++i) {
            Vec3 goal = from + static_cast<double>(i) / pieces * way;
            if (i < pieces) goal += 0.012 * clumsy_ * Vec3{normal(), normal(), normal()};
            move(goal, 0.9 + 45.0 * distance(goal, place_) * (0.6 + clumsy_) + 0.3 * clumsy_ * uniform());
            rest(clumsy_ * clumsy_ * 2.5 * uniform());
        }
    }
    void rest(double seconds)
    {
        hold(seconds, [](double) { return 0.0; });
    }
    /// Presses on a wall: the force follows half a sine wave.
    void touch(double newton, double seconds)
    {
        const double peak = newton * (1.0 + 2.2 * clumsy_ * uniform());
        hold(seconds, [=](double s) { return peak * std::sin(std::numbers::pi * s); });
    }
    /// Pulls with growing force until the tissue yields.
    void pull(Vec3 by, double newton, double seconds)
    {
        const Vec3 from = place_;
        const int steps = static_cast<int>(seconds * kRate);
        for (int i = 1; i <= steps; ++i) {
            const double s = static_cast<double>(i) / steps;
            put(from + s * s * by, (0.15 + 0.85 * s * s) * newton + 0.05 * clumsy_ * newton * normal());
        }
    }
    [[nodiscard]] double time() const { return static_cast<double>(samples.size()) / kRate; }
    double uniform() { return static_cast<double>(random_()) / 4294967296.0; }
    double normal()
    {
        // The sum of twelve uniform numbers is the same on every machine, unlike the library's distributions.
        double sum = -6.0;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sum;
    }

    std::vector<metric::Sample> samples;

private:
    void move(Vec3 to, double seconds)
    {
        const Vec3 from = place_;
        const int steps = std::max(1, static_cast<int>(seconds * kRate));
        // No hand moves in a straight line: the path bows to some side, and begins and ends at rest.
        const Vec3 bow = (0.06 + 0.2 * clumsy_) * distance(from, to) * Vec3{normal(), normal(), normal()};
        for (int i = 1; i <= steps; ++i) {
            const double s = static_cast<double>(i) / steps, aside = 16.0 * s * s * (1.0 - s) * (1.0 - s);
            put(from + s * s * s * (10.0 - 15.0 * s + 6.0 * s * s) * (to - from) + aside * bow, 0.0);
        }
    }
    template <class Force> void hold(double seconds, Force&& force)
    {
        const Vec3 here = place_;
        const int steps = static_cast<int>(seconds * kRate);
        for (int i = 1; i <= steps; ++i) put(here, force(static_cast<double>(i) / steps));
    }
    void put(Vec3 place, double force)
    {
        place_ = place;
        const double t = time(), tremor = 3e-5 * (0.3 + clumsy_), w = 2.0 * std::numbers::pi;
        const Vec3 shake =
            tremor * Vec3{std::sin(w * 8.3 * t), std::sin(w * 9.1 * t + 1.0), std::sin(w * 7.7 * t + 2.0)};
        const bool touching = force > 0.0;
        const Vec3 nowhere = {NAN, NAN, NAN};
        samples.push_back({.time = t,
                           .pose = {place + shake, axisAngle({1, 0, 0}, 0.2 * std::sin(0.3 * t))},
                           .force = {0.0, std::max(0.0, force), 0.0},
                           .contacts = touching ? 1 : 0,
                           .point = touching ? place : nowhere});
    }

    double clumsy_;
    std::mt19937 random_;
    Vec3 place_ = {0.0, 0.0, 0.06};
};

/// The scope behind the tool: it follows slowly, and its horizon drifts as the hand tires.
metric::Track scopeBehind(const std::vector<metric::Sample>& tool, double skill)
{
    metric::Track scope{.name = "hysteroscope", .role = metric::Role::Scope};
    Vec3 place = tool.front().pose.position + Vec3{0, 0, 0.025};
    for (const metric::Sample& sample : tool) {
        place += 0.01 * (sample.pose.position + Vec3{0, 0, 0.022} - place);
        const double roll = (1.0 - skill) * (0.25 * std::sin(0.21 * sample.time) + 0.1 * std::sin(0.67 * sample.time));
        scope.samples.push_back({.time = sample.time,
                                 .pose = {place, axisAngle({0, 0, 1}, roll)},
                                 .force = {},
                                 .contacts = 0,
                                 .point = {NAN, NAN, NAN}});
    }
    return scope;
}

} // namespace

metric::Session exampleSession(const std::string& trainee, const std::string& date, double skill, unsigned seed)
{
    metric::Session session{.trainee = trainee,
                            .task = "Hysteroscopic polypectomy",
                            .date = date,
                            .software = "filasofia report --example",
                            .seed = seed,
                            .idealPath = 0.26,
                            .forceLimit = 1.5,
                            .fieldOfView = 70.0 * std::numbers::pi / 180.0,
                            .targets = {"polyp"},
                            .steps = {"enter the cavity", "see the left ostium", "see the right ostium",
                                      "remove the polyp", "leave the cavity"}};
    session.watched = {EventKind::Tear, EventKind::Cut, EventKind::Perforation, EventKind::Mistake, EventKind::Removed};
    Hand hand(skill, seed);
    const auto mark = [&](EventKind kind, std::string what, std::optional<double> amount = {}) {
        session.events.push_back({hand.time(), kind, std::move(what), amount});
    };
    hand.rest(0.5);
    hand.reach({0.0, 0.002, 0.03});
    hand.touch(0.5, 0.8); // the wall of the canal
    hand.reach({0.0, 0.0, 0.0});
    mark(EventKind::Step, session.steps[0]);
    hand.reach({-0.022, 0.008, -0.028});
    if (hand.uniform() > skill) hand.touch(0.9, 0.6);
    mark(EventKind::Step, session.steps[1]);
    mark(EventKind::Seen, "cavity", 0.35 + 0.2 * skill);
    hand.rest(1.0);
    hand.reach({0.022, 0.008, -0.028});
    if (hand.uniform() > skill) {
        hand.touch(1.2, 0.7);
        mark(EventKind::Mistake, "scraped the wall");
    }
    mark(EventKind::Step, session.steps[2]);
    mark(EventKind::Seen, "cavity", 0.7 + 0.25 * skill);
    hand.rest(0.6);
    const int pulls = 1 + static_cast<int>(std::lround(2.0 * (1.0 - skill)));
    for (int i = 0; i < pulls; ++i) {
        hand.reach({0.006, -0.010, -0.024});
        mark(EventKind::Grasp, "polyp");
        hand.pull({0.0, 0.006, 0.012}, 1.1 + 0.9 * (1.0 - skill) + 0.1 * hand.normal(), 1.6);
        mark(i + 1 < pulls ? EventKind::Release : EventKind::Tear, "polyp",
             i + 1 < pulls ? std::nullopt : std::optional(2.8e-5));
    }
    mark(EventKind::Residual, "polyp", 0.12 * (1.0 - skill));
    mark(EventKind::Step, session.steps[3]);
    hand.reach({0.0, 0.0, 0.02});
    if (skill < 0.45) {
        hand.touch(1.6, 0.5);
        mark(EventKind::Tear, "uterus", 6e-6);
    }
    hand.reach({0.0, 0.0, 0.06});
    mark(EventKind::Removed, "polyp", 3.4e-7);
    mark(EventKind::Step, session.steps[4]);
    hand.rest(0.5);

    session.tracks = {{.name = "forceps", .samples = std::move(hand.samples)}};
    session.tracks.push_back(scopeBehind(session.tracks[0].samples, skill));
    return session;
}

Report exampleReport()
{
    const std::string trainee = "Example trainee";
    std::vector<Attempt> cohort;
    const std::array past = {0.10, 0.28, 0.42, 0.53};
    for (std::size_t i = 0; i < past.size(); ++i)
        cohort.push_back(attemptOf(exampleSession(trainee, "2026-11-" + std::to_string(10 + 2 * i) + " 09:00", past[i],
                                                  static_cast<unsigned>(100 + i))));
    const std::array others = {0.55, 0.70, 0.62, 0.85, 0.92, 0.78};
    for (std::size_t i = 0; i < others.size(); ++i)
        cohort.push_back(attemptOf(exampleSession("Colleague " + std::to_string(i + 1), "2026-11-02 10:00", others[i],
                                                  static_cast<unsigned>(200 + i))));
    return makeReport(exampleSession(trainee, "2026-11-18 09:00", 0.60, 104), "an example, generated by formulas",
                      std::move(cohort));
}

} // namespace filasofia::app
