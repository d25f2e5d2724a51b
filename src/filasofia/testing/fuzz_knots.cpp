#include "filasofia/testing/fuzz_knots.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/testing/fuzz_knot_scene.h"
#include "filasofia/testing/fuzz_stage.h"
#include "filasofia/testing/linking.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::testing {
namespace {

constexpr int kKnotKinds = static_cast<int>(KnotKind::count_);
constexpr long kLook = 10;            ///< steps between two looks at what is computed less often
constexpr std::size_t kExamples = 20; ///< that a report keeps

/// A scene that runs, and what is counted of it.
class KnotRun {
public:
    KnotRun(const KnotFuzzDef& def, KnotKind kind, std::uint64_t seed, KnotFuzzReport& report)
        : def_(def), report_(report), random_(seed), scene_(knotScene(kind, random_)), stage_(scene_.bodies, def.step)
    {
        readLines(after_);
        for (const auto& [i, k] : ringPairs()) linked_.push_back(linkingNumber(after_[i], after_[k]));
    }
    /// Runs it to its end; returns its hash.
    std::uint64_t run(KnotFuzzKind& counts, IterationCount& iterations, const std::string& called)
    {
        const long steps = std::max(1L, std::lround(def_.perScene / def_.step));
        for (long i = 0; i < steps; ++i) {
            const double time = static_cast<double>(i) * def_.step;
            for (FuzzHand& hand : scene_.hands) {
                hand.move(time, def_.step, random_);
                stage_.give(physics::SetPose{FuzzStage::idOf(hand.body), 0, hand.now});
            }
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
    void readLines(std::vector<std::vector<Vec3>>& out) const
    {
        out.resize(scene_.lines.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            const FuzzLine& line = scene_.lines[i];
            if (line.axis.empty()) {
                out[i] = stage_.frame().softBody(FuzzStage::idOf(line.body))->positions;
                continue;
            }
            const Pose& pose = stage_.frame().rigidBody(FuzzStage::idOf(line.body))->poses.front();
            out[i].clear();
            for (const Vec3 p : line.axis) out[i].push_back(pose.position + rotate(pose.orientation, p));
        }
    }
    [[nodiscard]] std::vector<std::array<std::size_t, 2>> ringPairs() const
    {
        std::vector<std::array<std::size_t, 2>> out;
        for (std::size_t i = 0; i < scene_.lines.size(); ++i)
            for (std::size_t k = i + 1; k < scene_.lines.size(); ++k)
                if (scene_.lines[i].closed && scene_.lines[k].closed) out.push_back({i, k});
        return out;
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
        for (std::size_t i = 0; i < scene_.lines.size(); ++i)
            for (std::size_t k = i; k < scene_.lines.size(); ++k) {
                if (!scene_.lines[i].axis.empty() && !scene_.lines[k].axis.empty()) continue; // bars meet as they like
                const int passed = std::abs(passes_.count({before_[i], after_[i], scene_.lines[i].closed},
                                                          {before_[k], after_[k], scene_.lines[k].closed}));
                counts.passes += passed;
                if (passed != 0)
                    say(text("body ", scene_.lines[i].body + 1, " passes through ", scene_.lines[k].body + 1));
            }
    }
    template <class Say> void lookRarely(const Say& say)
    {
        std::size_t pair = 0;
        for (const auto& [i, k] : ringPairs()) {
            ++report_.linkingTests;
            const double now = linkingNumber(after_[i], after_[k]);
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
    /// Nodes of threads that are more than two diameters deep in a block of tissue, by where they are in it at rest.
    [[nodiscard]] int nodesInside(std::size_t tissue) const
    {
        const auto& mesh = *std::get<std::shared_ptr<const geometry::TetMesh>>(
            std::get<physics::SoftBodyDef>(scene_.bodies[tissue]).mesh);
        const std::vector<Vec3>& x = stage_.frame().softBody(FuzzStage::idOf(tissue))->positions;
        Vec3 low = x.front(), high = x.front(), half = mesh.nodes.front();
        for (const Vec3 p : x) low = min(low, p), high = max(high, p);
        for (const Vec3 p : mesh.nodes) half = max(half, p);
        const auto isDeep = [&](const geometry::Tetrahedron& t, Vec3 p) {
            const auto w = geometry::barycentric(p, x[t[0]], x[t[1]], x[t[2]], x[t[3]]);
            Vec3 rest;
            for (std::size_t k = 0; k < 4; ++k) rest += w[k] * mesh.nodes[t[k]];
            const Vec3 depth = half - max(rest, -rest);
            return std::ranges::all_of(w, [](double each) { return each > 0.0; }) &&
                   std::min({depth.x, depth.y, depth.z}) > 4.0 * scene_.radius;
        };
        int count = 0;
        for (const std::vector<Vec3>& line : after_)
            for (const Vec3 p : line)
                if (min(p, low) == low && max(p, high) == high)
                    count += std::ranges::any_of(mesh.tetrahedra, [&](const auto& t) { return isDeep(t, p); });
        return count;
    }

    const KnotFuzzDef& def_;
    KnotFuzzReport& report_;
    FuzzRandom random_;
    KnotScene scene_;
    FuzzStage stage_;
    std::vector<std::vector<Vec3>> before_, after_; ///< per line
    std::vector<double> linked_;                    ///< per pair of rings
    PassCounter passes_;
};

} // namespace

KnotFuzzReport fuzzKnots(const KnotFuzzDef& def)
{
    KnotFuzzReport report;
    for (int i = 0; i < kKnotKinds; ++i) report.kinds.push_back({name(static_cast<KnotKind>(i))});
    IterationCount iterations;
    Hasher all;
    for (auto index = static_cast<std::uint64_t>(def.first); report.seconds < def.seconds * (1.0 - 1e-9); ++index) {
        runScene<KnotRun, KnotKind>(def, index, report, iterations, all);
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
