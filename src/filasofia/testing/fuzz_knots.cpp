#include "filasofia/testing/fuzz_knots.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/testing/fuzz_knot_scene.h"
#include "filasofia/testing/fuzz_stage.h"
#include "filasofia/testing/linking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace filasofia::testing {
namespace {

constexpr long kLook = 10;                  ///< steps between two looks at what is computed less often
constexpr std::size_t kExamples = 20;       ///< that a report keeps
constexpr std::uint32_t kFirstGrasp = 1000; ///< id of the first grasp, beyond those of all attachments

/// A scene that runs, and what is counted of it.
class KnotRun {
public:
    KnotRun(const KnotFuzzDef& def, KnotKind kind, std::uint64_t seed, KnotFuzzReport& report)
        : def_(def), report_(report), random_(seed), scene_(knotScene(kind, random_)), stage_(scene_.bodies, def.step)
    {
        readLines(after_);
        for (const auto& [i, k] : ringPairs()) linked_.push_back(linkingNumber(closedLine(i), closedLine(k)));
        off_.resize(linked_.size());
    }
    /// Runs it to its end; returns its hash.
    std::uint64_t run(KnotFuzzKind& counts, IterationCount& iterations, const std::string& called)
    {
        const long steps = std::max(1L, std::lround(def_.perScene / def_.step));
        for (long i = 0; i < steps; ++i) {
            const double time = static_cast<double>(i) * def_.step;
            command(time);
            const physics::StepReport step = stage_.step(def_.step);
            std::swap(before_, after_);
            readLines(after_);
            const auto say = [&](const auto& what) {
                if (report_.examples.size() < kExamples)
                    report_.examples.push_back(text(called, ", step ", i, ": ", what));
            };
            follow(step, counts, iterations);
            lookAtLines(counts, say);
            if (i % kLook == kLook - 1) lookRarely(say);
        }
        counts.steps += steps;
        report_.steps += steps;
        report_.seconds += static_cast<double>(steps) * def_.step;
        return stage_.hash();
    }

private:
    void command(double time)
    {
        for (FuzzHand& hand : scene_.hands) {
            hand.move(time, def_.step, random_);
            const BodyId id = FuzzStage::idOf(hand.body);
            if (hand.opens == 0.0) {
                stage_.give(physics::SetPose{id, 0, hand.now});
                continue;
            }
            for (const int which : {0, 1}) stage_.give(physics::SetPose{id, which, hand.jaw(which, time)});
        }
        for (; grasped_ < scene_.grasps.size() && scene_.grasps[grasped_].time <= time; ++grasped_) {
            const FuzzGrasp& grasp = scene_.grasps[grasped_];
            stage_.give(physics::Grasp{AttachmentId{kFirstGrasp + static_cast<std::uint32_t>(grasped_)},
                                       FuzzStage::idOf(grasp.jaw), FuzzStage::idOf(grasp.target)});
        }
    }
    void readLines(std::vector<std::vector<Vec3>>& out) const
    {
        out.resize(scene_.lines.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            const FuzzLine& line = scene_.lines[i];
            if (line.axis.empty()) {
                out[i] = stage_.frame().softBody(FuzzStage::idOf(line.body))->positions;
                if (!line.sections.empty()) out[i] = middles(line.sections, out[i]);
                continue;
            }
            const Pose& pose = stage_.frame().rigidBody(FuzzStage::idOf(line.body))->poses.front();
            out[i].clear();
            for (const Vec3 p : line.axis) out[i].push_back(pose.position + rotate(pose.orientation, p));
            if (!line.thread) continue;
            const auto& nodes = stage_.frame().softBody(FuzzStage::idOf(*line.thread))->positions;
            out[i].back() = nodes.front(); // the same place, or the thread has come off: lookAtEnd()
            out[i].insert(out[i].end(), nodes.begin() + 1, nodes.end());
        }
    }
    static std::vector<Vec3> middles(const std::vector<std::vector<int>>& sections, const std::vector<Vec3>& x)
    {
        std::vector<Vec3> out;
        for (const std::vector<int>& each : sections) {
            Vec3 sum;
            for (const int node : each) sum += x[static_cast<std::size_t>(node)];
            out.push_back(sum / static_cast<double>(each.size()));
        }
        return out;
    }
    [[nodiscard]] std::vector<std::array<std::size_t, 2>> ringPairs() const
    {
        std::vector<std::array<std::size_t, 2>> out;
        const auto closes = [](const FuzzLine& line) { return line.closed || !line.sections.empty(); };
        for (std::size_t i = 0; i < scene_.lines.size(); ++i)
            for (std::size_t k = i + 1; k < scene_.lines.size(); ++k)
                if (closes(scene_.lines[i]) && closes(scene_.lines[k])) out.push_back({i, k});
        return out;
    }
    /// A line that is closed: a cylinder's axis far around all that moves.
    [[nodiscard]] std::vector<Vec3> closedLine(std::size_t i) const
    {
        std::vector<Vec3> line = after_[i];
        if (scene_.lines[i].closed) return line;
        const Vec3 along = line.back() - line.front();
        constexpr double far = 10.0; // [-] over the cylinder's length
        const Vec3 aside = far * length(along) * normalized(cross(along, {0, 1, 0}), {1, 0, 0});
        for (const double end : {1.0, -1.0})
            line.push_back((end > 0.0 ? after_[i].back() : after_[i].front()) + end * far * along);
        line.insert(line.end() - 1, {line[line.size() - 2] + aside, line.back() + aside});
        return line;
    }
    /// Whether a ring has come over an end of the cylinder that it was around, which is no pass.
    [[nodiscard]] bool hasComeOff(std::size_t i, std::size_t k) const
    {
        const std::size_t axis = scene_.lines[i].sections.empty() ? k : i;
        if (scene_.lines[axis].sections.empty()) return false;
        const double low = after_[axis].front().z, high = after_[axis].back().z;
        return std::ranges::any_of(after_[axis == i ? k : i], [&](Vec3 p) { return p.z < low || p.z > high; });
    }
    void follow(const physics::StepReport& step, KnotFuzzKind& counts, IterationCount& iterations)
    {
        iterations.add(step);
        counts.notConverged += step.has(physics::StepFlag::NotConverged) ? 1 : 0;
        report_.undone += step.has(physics::StepFlag::Undone) ? 1 : 0;
        report_.mostContacts = std::max(report_.mostContacts, static_cast<long>(step.contacts.active));
        report_.deepest = std::max(report_.deepest, step.contacts.penetration / (2.0 * scene_.radius));
    }
    template <class Say> void lookAtLines(KnotFuzzKind& counts, const Say& say)
    {
        if (!stage_.isFinite()) {
            ++report_.notFinite;
            return say("not finite");
        }
        for (std::size_t i = 0; i < scene_.lines.size(); ++i) lookAtEnd(i, say);
        for (std::size_t i = 0; i < scene_.lines.size(); ++i)
            for (std::size_t k = i; k < scene_.lines.size(); ++k) {
                if (loose_ && (scene_.lines[i].thread || scene_.lines[k].thread)) continue;
                if (scene_.lines[i].isTool() && scene_.lines[k].isTool()) continue;
                if (i == k && !scene_.lines[i].sections.empty()) continue;
                const int passed = std::abs(passes_.count({before_[i], after_[i], scene_.lines[i].closed},
                                                          {before_[k], after_[k], scene_.lines[k].closed}));
                counts.passes += passed;
                if (passed != 0)
                    say(text("body ", scene_.lines[i].body + 1, " passes through ", scene_.lines[k].body + 1));
            }
    }
    /// A thread that has left its needle's tail leaves a gap, which others may go through.
    template <class Say> void lookAtEnd(std::size_t i, const Say& say)
    {
        const FuzzLine& line = scene_.lines[i];
        if (!line.thread) return;
        const Vec3 tail =
            transform(stage_.frame().rigidBody(FuzzStage::idOf(line.body))->poses.front(), line.axis.back());
        if (distance(tail, after_[i][line.axis.size() - 1]) < 4.0 * scene_.radius) return;
        if (std::exchange(loose_, true)) return;
        ++report_.looseEnds;
        say("a thread has left its needle's tail");
    }
    template <class Say> void lookRarely(const Say& say)
    {
        std::size_t pair = 0;
        for (const auto& [i, k] : ringPairs()) {
            off_[pair] = off_[pair] || hasComeOff(i, k);
            if (off_[pair]) {
                ++pair;
                continue;
            }
            ++report_.linkingTests;
            const double now = linkingNumber(closedLine(i), closedLine(k));
            if (std::abs(now - linked_[pair]) > 0.01) {
                ++report_.linkingChanges;
                say(text("linking number ", linked_[pair], " has become ", now));
                linked_[pair] = now;
            }
            ++pair;
        }
        for (const std::size_t tissue : scene_.tissues) {
            const int inside = nodesInside(tissue);
            report_.insideTissue += inside;
            if (inside > 0) say(text(inside, " nodes inside tissue"));
        }
    }
    /// Nodes of threads that are more than two diameters deep in tissue, by where they are in it at rest.
    [[nodiscard]] int nodesInside(std::size_t tissue) const
    {
        const auto& mesh = *std::get<std::shared_ptr<const geometry::TetMesh>>(
            std::get<physics::SoftBodyDef>(scene_.bodies[tissue]).mesh);
        const std::vector<Vec3>& x = stage_.frame().softBody(FuzzStage::idOf(tissue))->positions;
        Vec3 low = x.front(), high = x.front();
        for (const Vec3 p : x) low = min(low, p), high = max(high, p);
        const auto isDeep = [&](const geometry::Tetrahedron& t, Vec3 p) {
            const auto w = geometry::barycentric(p, x[t[0]], x[t[1]], x[t[2]], x[t[3]]);
            if (!std::ranges::all_of(w, [](double each) { return each > 0.0; })) return false;
            Vec3 rest;
            for (std::size_t k = 0; k < 4; ++k) rest += w[k] * mesh.nodes[t[k]];
            return depthAtRest(mesh, rest) > 4.0 * scene_.radius;
        };
        int count = 0;
        for (std::size_t i = 0; i < after_.size(); ++i)
            for (const Vec3 p : after_[i])
                if (scene_.lines[i].body != tissue && min(p, low) == low && max(p, high) == high)
                    count += std::ranges::any_of(mesh.tetrahedra, [&](const auto& t) { return isDeep(t, p); });
        return count;
    }

    static double depthAtRest(const geometry::TetMesh& mesh, Vec3 p)
    {
        const geometry::Surface surface = geometry::extractSurface(mesh); // seldom: a node is in the tissue
        double least = std::numeric_limits<double>::infinity();
        for (const geometry::Triangle& t : surface.mesh.triangles) {
            const auto at = [&](std::size_t k) { return surface.mesh.vertices[static_cast<std::size_t>(t[k])]; };
            least = std::min(least, geometry::nearestOnTriangle(p, at(0), at(1), at(2)).squaredDistance);
        }
        return std::sqrt(least);
    }

    const KnotFuzzDef& def_;
    KnotFuzzReport& report_;
    FuzzRandom random_;
    KnotScene scene_;
    FuzzStage stage_;
    std::vector<std::vector<Vec3>> before_, after_; ///< per line
    std::vector<double> linked_;                    ///< per pair of rings
    std::vector<bool> off_;                         ///< the same: it is not linked any more
    std::size_t grasped_ = 0;
    bool loose_ = false; ///< a thread has left its needle
    PassCounter passes_;
};

} // namespace

KnotFuzzReport fuzzKnots(const KnotFuzzDef& def)
{
    KnotFuzzReport report;
    const KnotKind first = def.tools ? kFirstKnotToolKind : KnotKind{},
                   end = def.tools ? KnotKind::count_ : kFirstKnotToolKind;
    for (auto kind = static_cast<int>(first); kind < static_cast<int>(end); ++kind)
        report.kinds.push_back({name(static_cast<KnotKind>(kind))});
    IterationCount iterations;
    Hasher all;
    for (auto index = static_cast<std::uint64_t>(def.first); report.seconds < def.seconds * (1.0 - 1e-9); ++index) {
        runScene<KnotRun>(def, first, index, report, iterations, all);
        if (def.progress) def.progress(report.seconds);
    }
    for (const KnotFuzzKind& kind : report.kinds) {
        report.passes += kind.passes;
        report.notConverged += kind.notConverged;
    }
    summarise(iterations, all, report);
    return report;
}

} // namespace filasofia::testing
