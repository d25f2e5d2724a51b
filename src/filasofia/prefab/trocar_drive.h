#pragma once

#include "filasofia/core/published.h"
#include "filasofia/prefab/trocar_shaft.h"
#include "filasofia/prefab/turns.h"
#include "filasofia/runtime/simulation.h"

#include <tuple>

namespace filasofia::prefab {

/// What a body in a trocar is: checked when the drive is made.
struct DriveDef {
    std::string object = {}; ///< what errors call it
    TrocarDef trocar = {};
    TrocarHandleDef hand = {};
    TrocarPose start = {};
};

/// Takes a shaft in its trocar from step to step: reads the forces on its body, moves the hand, and tells the report.
/// An instrument and a scope have one each.
class TrocarDrive {
public:
    TrocarDrive(runtime::Simulation& simulation, const DriveDef& def); ///< throws an Error if the Def is wrong

    [[nodiscard]] BodyId handle() const { return handle_; }
    [[nodiscard]] TrocarReport report() const { return newest_.read(); }
    void move(const TrocarPose& pose); ///< any thread; Error outside the limits
    /// Before a step that ends at `time`, on the stepping thread: returns the pose of the pivot. `grip` is where what
    /// the body holds pulls.
    Pose step(double time, BodyId body, Vec3 grip);

    // For remember().
    using Kept = std::tuple<TrocarPose, ShaftState, double, TrocarReport>;
    auto kept() { return std::tie(wanted_, state_, last_, report_); }
    void publish() { newest_.write(report_); }
    Turns turns; ///< guards the members below

private:
    [[nodiscard]] TrocarPose fromHandle(const frame::Frame& now) const;
    [[nodiscard]] ShaftLoad loadOn(const frame::Frame& now, BodyId body, Vec3 grip) const;
    void advance(double dt, BodyId body, Vec3 grip);

    runtime::Simulation& simulation_;
    const DriveDef def_;
    BodyId handle_ = {};
    TrocarPose wanted_;
    ShaftState state_;
    double last_ = 0.0; ///< [s], end of the last step
    TrocarReport report_;
    Published<TrocarReport> newest_; // for all threads
};

/// Lets a part with a `drive`, a body() and a go(pose) move before every step.
template <class Part> void driveEveryStep(runtime::Simulation& simulation, const std::shared_ptr<Part>& part)
{
    simulation.everyStep([weak = std::weak_ptr(part)](double time) {
        if (const auto its = weak.lock()) its->go(its->drive.step(time, its->body(), its->grip()));
    });
}

} // namespace filasofia::prefab
