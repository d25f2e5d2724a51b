#include "apps/filasofia/bench/contact_soak.h"

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/contact_moves.h"
#include "apps/filasofia/bench/load.h"
#include "filasofia/core/text.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;

constexpr double kSettle = 2.0;       ///< [s] before the tools arrive
constexpr double kRecover = 1.5;      ///< [s] at most 0.5 s for them to leave, then a rest
constexpr double kPinnedBelow = 0.02; ///< [m] contactBunny() is pinned below this height
constexpr double kSink = 0.05;        ///< [-] relative to the sum of proximities
constexpr double kStands = 1e-3;      ///< [m] largest motion of a box in a tower that counts as standing

long stepsOf(double seconds) { return std::lround(seconds / kContactStep); }

bool allFinite(const frame::Frame& frame)
{
    const auto fine = [](Vec3 v) { return isFinite(v); };
    for (const frame::SoftBodyFrame& body : frame.softBodies)
        if (!std::ranges::all_of(body.positions, fine) || !std::ranges::all_of(body.velocities, fine)) return false;
    for (const frame::RigidBodyFrame& body : frame.rigidBodies)
        if (!std::ranges::all_of(body.poses, [](const Pose& p) { return isFinite(p); }) ||
            !std::ranges::all_of(body.velocities, fine))
            return false;
    return true;
}

int invertedIn(const geometry::TetMesh& mesh, const std::vector<Vec3>& x)
{
    int count = 0;
    for (const auto& [a, b, c, d] : mesh.tetrahedra) {
        const auto at = [&](int i) { return x[static_cast<std::size_t>(i)]; };
        count += geometry::signedVolume(at(a), at(b), at(c), at(d)) > 0.0 ? 0 : 1;
    }
    return count;
}

/// Whether a point of the tool's axis lies inside the tissue. If so, the tool is in it by at least its radius, or has
/// passed through.
bool axisInside(const geometry::TetMesh& mesh, const std::vector<Vec3>& x, const Pose& tool, const Capsule& capsule)
{
    constexpr int kPoints = 11;
    std::array<Vec3, kPoints> axis;
    geometry::Box around;
    for (int i = 0; i < kPoints; ++i) {
        axis[static_cast<std::size_t>(i)] = transform(tool, {0, capsule.half * (2.0 * i / (kPoints - 1) - 1.0), 0});
        around = merged(around, axis[static_cast<std::size_t>(i)]);
    }
    for (const geometry::Tetrahedron& t : mesh.tetrahedra) {
        std::array<Vec3, 4> c;
        geometry::Box box;
        for (std::size_t k = 0; k < 4; ++k) box = merged(box, c[k] = x[static_cast<std::size_t>(t[k])]);
        if (!overlap(box, around) || !(geometry::signedVolume(c[0], c[1], c[2], c[3]) > 0.0)) continue;
        for (Vec3 p : axis)
            if (std::ranges::min(geometry::barycentric(p, c[0], c[1], c[2], c[3])) > 0.0) return true;
    }
    return false;
}

/// Checks made after each step of every long run.
void inspect(const physics::StepReport& step, const frame::Frame& frame, const std::string& doing, SoakReport& report)
{
    report.seconds = step.time;
    if (step.contacts.penetration > report.penetration) {
        report.penetration = step.contacts.penetration;
        report.penetratedAt = step.time;
        report.penetrating = doing;
    }
    report.touching += step.contacts.active > 0 ? 1 : 0;
    report.maxPushing = std::max(report.maxPushing, step.contacts.active);
    report.flags |= step.flags;
    if (step.flags != 0) report.flagged.add(step.time, doing);
    if (!allFinite(frame)) report.notFinite.add(step.time, doing);
}

class WallClock {
public:
    explicit WallClock(SoakReport& report) : report_(report), begun_(runtime::steadyClock().now()) {}
    ~WallClock() { report_.wall = 1e-9 * static_cast<double>(runtime::steadyClock().now() - begun_); }
    WallClock(const WallClock&) = delete;
    WallClock& operator=(const WallClock&) = delete;

private:
    SoakReport& report_;
    runtime::Nanoseconds begun_;
};

/// Continues without tools and records what remains of the deformation.
void recover(const geometry::TetMesh& mesh, const std::vector<Vec3>& rested, ContactRun& run, SoakReport& report)
{
    for (long i = 0; i < stepsOf(kRecover); ++i) {
        const physics::StepReport step = run.step();
        inspect(step, run.capture(), "recovering", report);
    }
    const std::vector<Vec3>& x = run.capture().softBodies.front().positions;
    report.invertedAtEnd = invertedIn(mesh, x);
    for (std::size_t i = 0; i < x.size(); ++i)
        report.displacedAtEnd = std::max(report.displacedAtEnd, distance(x[i], rested[i]));
}

json toJson(const Mishap& mishap)
{
    return {{"steps", mishap.steps}, {"first_s", mishap.first ? json(*mishap.first) : json()}, {"when", mishap.when}};
}

json toJson(const SoakReport& r)
{
    return {{"scene", r.scene},
            {"simulated_s", r.seconds},
            {"wall_s", r.wall},
            {"proximity_m", r.proximity},
            {"penetration_m", r.penetration},
            {"penetration_at_s", r.penetratedAt},
            {"penetration_when", r.penetrating},
            {"not_finite", toJson(r.notFinite)},
            {"flagged", toJson(r.flagged)},
            {"flags", r.flags},
            {"through", toJson(r.through)},
            {"inverted", toJson(r.inverted)},
            {"steps_touching", r.touching},
            {"most_pushing", r.maxPushing},
            {"inverted_at_end", r.invertedAtEnd},
            {"displaced_at_end_m", r.displacedAtEnd},
            {"lean_m", r.lean}};
}

std::string written(const Mishap& mishap)
{
    if (mishap.steps == 0) return "0";
    return text(mishap.steps, " (first at ", *mishap.first, " s, ", mishap.when, ")");
}

void print(const SoakReport& r)
{
    std::printf("%s: %g s simulated in %.1f s; contacts pushed in %ld steps, at most %d contacts at once\n",
                r.scene.c_str(), r.seconds, r.wall, r.touching, r.maxPushing);
    std::printf(
        "  deepest penetration %.4f mm (at %.3f s, %s); steps with a state that is not finite: %s; flags %u, in steps: "
        "%s\n",
        1e3 * r.penetration, r.penetratedAt, r.penetrating.c_str(), written(r.notFinite).c_str(), r.flags,
        written(r.flagged).c_str());
    std::printf("  steps with a tool's axis inside the tissue: %s; with inverted elements: %s\n",
                written(r.through).c_str(), written(r.inverted).c_str());
    std::printf("  at the end: %d inverted elements, largest displacement %.4f mm, tower moved by %.4f mm\n",
                r.invertedAtEnd, 1e3 * r.displacedAtEnd, 1e3 * r.lean);
    std::fflush(stdout);
}

std::vector<Verdict> judge(const SoakReport& tools, const SoakReport& ball, const SoakReport& tower)
{
    const long lost = tools.notFinite.steps + ball.notFinite.steps + tower.notFinite.steps;
    return {{"every state is finite", lost == 0, text(lost, " steps with a state that is not finite")},
            {"no inverted element is left at the end", tools.invertedAtEnd + ball.invertedAtEnd == 0,
             text(tools.invertedAtEnd + ball.invertedAtEnd, " inverted elements")},
            {"no tool passes through the tissue", tools.through.steps == 0,
             text("its axis is inside the tissue in ", written(tools.through), " steps")},
            {"the soft ball sinks in by at most 5 % of the sum of proximities",
             ball.penetration <= kSink * ball.proximity,
             text(100.0 * rounded(ball.penetration / ball.proximity, 1e4), " %, after ", ball.seconds, " s")},
            {"the tower stands", tower.lean <= kStands,
             text("a box moved by ", 1e3 * rounded(tower.lean, 1e7), " mm in ", tower.seconds, " s")}};
}

} // namespace

void Mishap::add(double time, const std::string& doing)
{
    if (steps++ > 0) return;
    first = time;
    when = doing;
}

SoakReport soakTools(double seconds, int seed)
{
    const Capsule capsule;
    const physics::SoftBodyDef bunny = contactBunny(3004, true);
    const geometry::TetMesh& mesh = *physics::loadMesh(bunny);
    const auto shape = geometry::shapes::capsule(capsule.radius, 2.0 * capsule.half);
    std::array<Pose, 2> poses{Pose{{0.3, 0.1, 0}, {}}, Pose{{-0.3, 0.1, 0}, {}}};
    std::optional<RandomMoves> moves; // around the bunny in its rest state under gravity, which differs from the mesh
    ContactScene scene{.bodies = {bunny, contactTool("tool", shape, poses[0]), contactTool("jaw", shape, poses[1])}};
    scene.path = [&](double time) {
        if (moves) poses = moves->at(time - kSettle);
        return std::vector{std::pair{BodyId{2}, poses[0]}, std::pair{BodyId{3}, poses[1]}};
    };
    SoakReport report{.scene = text("tools, seed ", seed)};
    const WallClock clock(report);
    ContactRun run(scene, 1);
    for (long i = 0; i < stepsOf(kSettle); ++i) run.step();
    const std::vector<Vec3> rested = run.capture().softBodies.front().positions;
    moves.emplace(geometry::TetMesh{rested, mesh.tetrahedra}, kPinnedBelow, capsule, seed);
    for (long i = 0; i < stepsOf(seconds); ++i) {
        const physics::StepReport step = run.step();
        const frame::Frame& frame = run.capture();
        inspect(step, frame, moves->doing(), report);
        const std::vector<Vec3>& x = frame.softBodies.front().positions;
        if (axisInside(mesh, x, poses[0], capsule) || axisInside(mesh, x, poses[1], capsule))
            report.through.add(step.time, moves->doing());
        if (invertedIn(mesh, x) > 0) report.inverted.add(step.time, moves->doing());
    }
    moves->leave(run.time() - kSettle);
    recover(mesh, rested, run, report);
    return report;
}

SoakReport soakBall(double seconds)
{
    const ContactScene scene = ballOnFloor();
    const geometry::TetMesh& mesh = *physics::loadMesh(std::get<physics::SoftBodyDef>(scene.bodies[1]));
    SoakReport report{.scene = "soft ball on a floor"};
    const WallClock clock(report);
    ContactRun run(scene, 1);
    for (long i = 0; i < stepsOf(seconds); ++i) {
        const physics::StepReport step = run.step();
        inspect(step, run.capture(), "", report);
    }
    report.invertedAtEnd = invertedIn(mesh, run.capture().softBodies.front().positions);
    return report;
}

SoakReport soakTower(double seconds)
{
    SoakReport report{.scene = "tower of five boxes"};
    const WallClock clock(report);
    ContactRun run(towerOfFive(), 1);
    const frame::Frame start = run.capture();
    for (long i = 0; i < stepsOf(seconds); ++i) {
        const physics::StepReport step = run.step();
        inspect(step, run.capture(), "", report);
    }
    const frame::Frame& end = run.capture();
    for (std::size_t b = 0; b < end.rigidBodies.size(); ++b)
        report.lean = std::max(report.lean,
                               distance(end.rigidBodies[b].poses[0].position, start.rigidBodies[b].poses[0].position));
    return report;
}

json soakContact(double minutes, int seed)
{
    const OthersLoad others;
    std::vector<SoakReport> all;
    const auto add = [&](const SoakReport& report) {
        all.push_back(report);
        print(report);
    };
    add(soakTools(60.0 * minutes, seed));
    add(soakBall(60.0 * std::min(minutes, 10.0)));
    add(soakTower(60.0 * std::min(minutes, 1.0)));
    json reports = json::array();
    for (const SoakReport& report : all) reports.push_back(toJson(report));
    return {{"bench", "contact soak"},
            {"minutes", minutes},
            {"seed", seed},
            {"cores_taken_by_others", others.cores()},
            {"runs", reports},
            {"limits", printVerdicts(judge(all[0], all[1], all[2]))}};
}

} // namespace filasofia::app
