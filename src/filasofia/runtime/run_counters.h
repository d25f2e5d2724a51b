#pragma once

#include "filasofia/runtime/attachment_watch.h"
#include "filasofia/runtime/run.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace filasofia::runtime {

/// Counts steps and what went wrong in them. Used by the stepping thread, and by others after it has ended.
class RunCounters {
public:
    /// Begins a run: all counts but stepsEver() return to zero.
    void begin()
    {
        undone_ = undoneAtEnd_ = damped_ = notConverged_ = outOfTime_ = inverted_ = beyondStrain_ = 0;
        restless_ = energyGained_ = intersecting_ = nothingChanged_ = 0;
        lastUndone_ = -kApart;
        firstUndone_ = {};
        deepest_ = {};
        unrest_ = {};
        worst_ = {};
        mostStrained_ = {};
        opened_.clear();
        refused_ = {};
        idleBlades_.clear();
        lost_.clear();
        clips_ = {};
        attachments_.begin();
    }
    void count(const physics::StepReport& report)
    {
        ++stepsEver_;
        undone_ += report.has(physics::StepFlag::Undone);
        newlyUndone_ = report.has(physics::StepFlag::Undone) && !(report.time < lastUndone_ + kApart);
        if (report.has(physics::StepFlag::Undone)) lastUndone_ = report.time;
        if (!report.undone.empty() && !firstUndone_) firstUndone_ = report.undone.front();
        if (report.dt > 0.0) undoneAtEnd_ = report.has(physics::StepFlag::Undone) ? undoneAtEnd_ + 1 : 0;
        damped_ += report.has(physics::StepFlag::Damped);
        notConverged_ += report.has(physics::StepFlag::NotConverged);
        outOfTime_ += report.has(physics::StepFlag::OutOfTime);
        inverted_ += report.inverted.count > 0;
        if (report.inverted.count > worst_.count) worst_ = report.inverted;
        const physics::StrainedElements& strained = report.beyondStrain;
        beyondStrain_ += strained.count > 0;
        if (strained.count > 0 &&
            (mostStrained_.count == 0 || strained.strain * mostStrained_.valid > mostStrained_.strain * strained.valid))
            mostStrained_ = strained;
        intersecting_ += report.has(physics::StepFlag::Intersecting);
        for (const physics::Intersection& each : report.intersections)
            if (each.depth > deepest_.depth) deepest_ = each;
        restless_ += report.has(physics::StepFlag::Restless);
        energyGained_ += report.has(physics::StepFlag::EnergyGained);
        if (report.unrest.speed > unrest_.speed) unrest_ = report.unrest;
        countOpened(report.topology.ruptures);
        for (const physics::LostPiece& each : report.topology.lostPieces) {
            Lost& lost = lost_[each.body];
            ++lost.pieces;
            lost.mass += each.mass;
            lost.share += each.share;
        }
        nothingChanged_ += report.has(physics::StepFlag::NothingChanged);
        clips_.applied += report.clips.applied;
        clips_.missed += report.clips.missed;
        clips_.slipped += report.clips.slipped;
        clips_.partial += report.clips.partial;
        attachments_.count(report);
        const physics::TopologyReport& blades = report.topology;
        refused_.steps += blades.bladesRefused() > 0;
        refused_.jumped += blades.bladeJump + blades.bladeTooFast > 0;
        refused_.off += blades.bladeOff > 0;
        refused_.inVain += static_cast<std::uint64_t>(blades.inVain);
        refused_.noPiece += static_cast<std::uint64_t>(blades.noPiece);
        if (report.dt > 0.0) idleBlades_ = blades.idleBlades;
    }
    /// The steps of all runs, paused ones included.
    [[nodiscard]] std::uint64_t stepsEver() const { return stepsEver_; }
    /// Whether the last step was undone, and none in the second before it: one that is to be told.
    [[nodiscard]] bool newlyUndone() const { return newlyUndone_; }
    [[nodiscard]] BodyId firstUndone() const { return firstUndone_; } ///< in this run; none if none was
    [[nodiscard]] const AttachmentWatch& attachments() const { return attachments_; }
    /// What bodies have lost, without their names.
    using Lost = LostPiecesReport;
    [[nodiscard]] const std::map<BodyId, Lost>& lost() const { return lost_; }
    /// What was opened, by body, without their names.
    [[nodiscard]] const std::map<BodyId, OpenedSurfaces>& opened() const { return opened_; }
    /// Bodies of which blades cut nothing, as of the last step.
    [[nodiscard]] const std::vector<BodyId>& idleBlades() const { return idleBlades_; }
    void fill(RunReport& report) const
    {
        report.undone = undone_;
        report.undoneAtEnd = undoneAtEnd_;
        report.damped = damped_;
        report.notConverged = notConverged_;
        report.outOfTime = outOfTime_;
        report.inverted = inverted_;
        report.worstInverted = worst_;
        report.beyondStrain = beyondStrain_;
        report.worstStrained = mostStrained_;
        report.intersecting = intersecting_;
        report.deepestIntersection = deepest_;
        report.restless = restless_;
        report.energyGained = energyGained_;
        report.worstUnrest = unrest_;
        report.nothingChanged = nothingChanged_;
        report.refused = refused_;
        report.clips = clips_;
    }

private:
    static constexpr double kApart = 1.0; ///< [s] undone steps that are nearer to each other are told once
    void countOpened(const std::vector<physics::Rupture>& ruptures)
    {
        for (auto each = ruptures.begin(); each != ruptures.end(); ++each) {
            OpenedSurfaces& opened = opened_[each->body];
            const auto same = [&](const physics::Rupture& other) { return other.body == each->body; };
            opened.steps += std::none_of(ruptures.begin(), each, same);
            (each->kind == physics::Rupture::Kind::Cut ? opened.cut : opened.torn) += each->area;
            opened.pieces += each->detached.size();
            opened.cavities += each->cavities.size();
        }
    }

    std::uint64_t stepsEver_ = 0;
    double lastUndone_ = -kApart; ///< [s]
    BodyId firstUndone_ = {};     ///< the first body that was undone
    bool newlyUndone_ = false;
    /// [-] steps of this run
    std::uint64_t undone_ = 0, undoneAtEnd_ = 0, damped_ = 0, notConverged_ = 0, outOfTime_ = 0, inverted_ = 0,
                  beyondStrain_ = 0;
    std::uint64_t restless_ = 0, energyGained_ = 0, intersecting_ = 0, nothingChanged_ = 0; ///< [-] steps
    physics::Intersection deepest_;          ///< in the step in which it was deepest
    physics::InvertedElements worst_;        ///< of the step with the most of them
    physics::StrainedElements mostStrained_; ///< in the step with the largest strain in relation to its range
    std::map<BodyId, OpenedSurfaces> opened_;
    RefusedBlades refused_;
    std::vector<BodyId> idleBlades_;
    std::map<BodyId, Lost> lost_;
    physics::ClipReport clips_;
    AttachmentWatch attachments_;
    physics::Unrest unrest_; ///< in the step with the fastest body
};

} // namespace filasofia::runtime
