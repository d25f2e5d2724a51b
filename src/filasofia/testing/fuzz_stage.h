#pragma once

#include "filasofia/core/hash.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/world.h"
#include "filasofia/frame/frame.h"
#include "filasofia/physics/defs.h"
#include "filasofia/testing/fuzz_random.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace filasofia::testing {

/// An engine with the bodies of a random scene: body i has the id i + 1, and no body has an attachment to a later one.
class FuzzStage {
public:
    FuzzStage(const std::vector<physics::BodyDef>& bodies, double period)
        : engine_(std::make_unique<engine::World>(engine::NativeEngineDef{.period = period, .threads = 1}))
    {
        std::uint32_t attachment = 1;
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const auto body = std::make_shared<const physics::BodyDef>(bodies[i]);
            give(physics::AddBody{idOf(i), body, engine_->build(*body), AttachmentId{attachment}});
            attachment +=
                std::visit([](const auto& d) { return static_cast<std::uint32_t>(d.attachments.size()); }, *body);
        }
        step(0.0);
    }
    static BodyId idOf(std::size_t body) { return {static_cast<std::uint32_t>(body + 1)}; }

    template <class C> void give(C command) { commands_.emplace_back(std::in_place_type<C>, std::move(command)); }
    physics::StepReport step(double dt)
    {
        physics::StepReport report = engine_->step({.dt = dt, .commands = commands_});
        commands_.clear();
        engine_->capture(frame_);
        return report;
    }
    [[nodiscard]] const frame::Frame& frame() const { return frame_; }
    [[nodiscard]] std::uint64_t hash() const { return engine_->hash(); }
    [[nodiscard]] physics::MechanicalEnergy energyOf(std::size_t body) const { return engine_->energyOf(idOf(body)); }
    /// What the engine knows of a soft body that blades may have cut.
    [[nodiscard]] const engine::SoftBody& soft(std::size_t body) const
    {
        return engine_->scene().soft[engine::findBody(engine_->scene(), idOf(body))->index];
    }
    /// [m] How long the paths are now that needles have cut into a tissue. A thread that is stretched in one is longer
    /// than frame::Channel::length, which counts it at rest.
    [[nodiscard]] double lengthOfChannels(std::size_t tissue) const
    {
        const std::vector<Vec3>& x = soft(tissue).state.x;
        double sum = 0.0;
        for (const engine::Channel& each : engine_->scene().channels) {
            if (each.tissue != idOf(tissue)) continue;
            Vec3 last = engine::meanOf(each.points.front().nodes, x);
            for (const engine::ChannelPoint& point : each.points) {
                const Vec3 at = engine::meanOf(point.nodes, x);
                sum += distance(last, at);
                last = at;
            }
            sum += distance(last, engine::meanOf(each.end, x));
        }
        return sum;
    }
    /// Whether every place and every velocity of the frame is a number.
    [[nodiscard]] bool isFinite() const
    {
        const auto numbers = [](const std::vector<Vec3>& list) {
            return std::ranges::all_of(list, [](Vec3 v) { return filasofia::isFinite(v); });
        };
        const auto places = [](const Pose& pose) { return filasofia::isFinite(pose); };
        return std::ranges::all_of(frame_.softBodies,
                                   [&](const auto& b) { return numbers(b.positions) && numbers(b.velocities); }) &&
               std::ranges::all_of(frame_.rigidBodies, [&](const auto& b) {
                   return std::ranges::all_of(b.poses, places) && numbers(b.velocities) && numbers(b.angularVelocities);
               });
    }

private:
    std::unique_ptr<engine::World> engine_;
    std::vector<physics::Command> commands_;
    frame::Frame frame_;
};

/// How many steps took how many iterations, of the solve with the most.
class IterationCount {
public:
    void add(const physics::StepReport& step)
    {
        int most = 0;
        for (const physics::BodySolve& solve : step.solves) most = std::max(most, solve.iterations);
        ++steps_[std::min(static_cast<std::size_t>(most), steps_.size() - 1)];
        ++all_;
    }
    /// The smallest number of iterations that at least this share of the steps did not exceed.
    [[nodiscard]] int quantile(double share) const
    {
        long sum = 0;
        for (std::size_t i = 0; i < steps_.size(); ++i)
            if (sum += steps_[i]; static_cast<double>(sum) >= share * static_cast<double>(all_))
                return static_cast<int>(i);
        return 0;
    }

private:
    std::vector<long> steps_ = std::vector<long>(1000);
    long all_ = 0;
};

/// Runs a scene, of the kind that its number gives, from the first one on; a second time, if the Def says so. A Run is
/// made for a Def, a kind, a seed and a report, and its run() returns a hash.
template <class Run, class Def, class Kind, class Report>
void runScene(const Def& def, Kind first, std::uint64_t index, Report& report, IterationCount& iterations, Hasher& all)
{
    const auto place = static_cast<std::size_t>(index % report.kinds.size());
    const auto kind = static_cast<Kind>(static_cast<std::size_t>(first) + place);
    auto& counts = report.kinds[place];
    const std::string called = text("scene ", index, " (", counts.name, ")");
    const auto runOnce = [&](Report& into, auto& kindCounts, IterationCount& its) {
        return Run(def, kind, seedOfScene(def.seed, index), into).run(kindCounts, its, called);
    };
    const std::uint64_t hash = runOnce(report, counts, iterations);
    all.add(hash);
    ++counts.scenes;
    ++report.scenes;
    if (!def.twice) return;
    Report again;
    auto other = counts;
    IterationCount its;
    if (runOnce(again, other, its) != hash) ++report.hashesThatDiffer;
}

/// What all scenes have in common.
template <class Report> void summarise(const IterationCount& iterations, const Hasher& all, Report& report)
{
    report.median = iterations.quantile(0.5);
    report.percentile99 = iterations.quantile(0.99);
    report.most = iterations.quantile(1.0);
    report.hash = all.value();
}

} // namespace filasofia::testing
