#pragma once

#include "filasofia/prefab/instrument_tie.h"

#include "filasofia/core/published.h"
#include "filasofia/prefab/fingers.h"
#include "filasofia/prefab/hand_step.h"
#include "filasofia/prefab/strand_hand.h"
#include "filasofia/prefab/tie_driver.h"
#include "filasofia/prefab/tie_plan.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <string_view>
#include <tuple>
#include <vector>

namespace filasofia::prefab {

enum class TiePhase {
    Idle,    ///< holds nothing
    Take,    ///< the hand holds its strand from the next step on, the assistant the tail
    Show,    ///< the hand lifts its strand, the assistant brings the tail to where the driver will take it
    Come,    ///< the driver comes over the wound, behind the long strand
    Wind,    ///< the hand goes around the shaft
    Reach,   ///< the driver comes down, and opens its jaws
    Feed,    ///< the assistant brings the tail between them
    Close,   ///< they close
    Pinch,   ///< fingers hold the loops
    Draw,    ///< the driver draws the tail back through them
    Spread,  ///< hand and driver go down, each to the other side
    Tighten, ///< and draw
    Lay,     ///< the driver lays the tail down
    Leave,   ///< lets go of it and draws back
    Go,      ///< it goes back to where it waits
    Done,    ///< all throws are tied; hand and assistant hold their strands, slack
    Failed   ///< the tail has not come between the jaws, or not through the loops
};

/// What an InstrumentTie does. Its phases are in tie_phases.cpp, the rest in instrument_tie.cpp.
struct InstrumentTie::Impl {
    static constexpr int kFingers = 12;   ///< [-] for each turn
    static constexpr double kOpen = 0.25; ///< [-] opening of the driver's jaws, as they reach for the tail
    struct Told {
        int tied = 0;
        bool done = false, failed = false;
        double largest = 0.0;
    };

    Impl(runtime::Simulation& sim, const InstrumentTieDef& given);

    // Any thread.
    void begin();
    void release();

    // Stepping thread, before each step.
    void step(double time);
    void seize(const frame::Frame& now, const frame::SoftBodyFrame& thread);
    void hold(StrandHand& with, int node);
    void letGo(StrandHand& with);
    void reachTail(const frame::Frame& now, const frame::SoftBodyFrame& thread);
    void takeTail(); ///< the assistant does
    void leaveTail();
    void next(TiePhase to);
    [[nodiscard]] Vec3 nodeOf(const frame::SoftBodyFrame& thread, int which) const;
    void measure(const frame::SoftBodyFrame& thread); ///< where the strands leave the tissue, and how long they are
    void openFingers();
    [[nodiscard]] int mostFingers() const { return kFingers * std::ranges::max(def.turns); }
    [[nodiscard]] HandStep handStep(const frame::Frame& now, double dt) const
    {
        return {simulation, now, def.place, def.up, def.stiffness, def.speed, dt};
    }

    // The phases.
    void work(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt); ///< a step of the present one
    bool lift(const frame::Frame& now, double aside, double dt);
    bool bring(const frame::Frame& now, Vec3 to, Vec3 inwards, double dt);
    [[nodiscard]] bool rests() const;
    void show(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt);
    void come(const frame::Frame& now, double dt);
    [[nodiscard]] double turnsNow() const;
    [[nodiscard]] Vec3 leavesAt() const;
    void wind(const frame::Frame& now, double dt);
    void keepClear();
    void reach(const frame::Frame& now, double dt);
    void feed(const frame::Frame& now, double dt);
    void close(const frame::Frame& now, double dt);
    void giveUp(std::string_view why);
    void pinch(const frame::SoftBodyFrame& thread);
    [[nodiscard]] std::vector<int> loopNodes(const frame::SoftBodyFrame& thread) const;
    double driverStep(const frame::Frame& now, double force, double speed, double dt); ///< [m]
    void drawThrough(const frame::Frame& now, double dt);
    bool drawTail(const frame::Frame& now, double force, double dt);
    bool part(const frame::Frame& now, double force, double dt);
    void spread(const frame::Frame& now, double dt);
    void tighten(const frame::Frame& now, double dt);
    void lay(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt);
    void settle(const frame::Frame& now, double dt);
    void leave(const frame::Frame& now, double dt);

    void publish()
    {
        told.write(
            {.tied = throws, .done = phase == TiePhase::Done, .failed = phase == TiePhase::Failed, .largest = largest});
    }
    using Kept =
        std::tuple<StrandHand, StrandHand, StrandHand, Fingers, Vec3, Fingers, Fingers, std::vector<int>, TiePlan, Pose,
                   Pose, TiePhase, bool, int, int, double, double, double, double, double, double, double>;
    auto kept()
    {
        return std::tie(hand, tail, assistant, second, beside, fingers, pinching, bases, plan, driver.pose, parting,
                        phase, wanted, throws, way, angle, since, still, drawn, pulled, stiff, largest);
    }

    runtime::Simulation& simulation;
    const InstrumentTieDef def;
    TieDriver driver;
    BodyId fingersBody = {};
    Turns turns; // guards the members below
    StrandHand hand;
    StrandHand tail;                 ///< where the driver holds the tail
    StrandHand assistant;            ///< shows the tail to the driver, with two fingers, so that it can turn it
    Fingers second;                  ///< the second of them
    Vec3 beside = {};                ///< [m] from the first one to it
    Fingers fingers;                 ///< hold the loops while the tail is drawn through them
    Fingers pinching;                ///< hold the last throw while the next one is made
    std::vector<int> bases = {0, 0}; ///< [-] nodes of the strands where they leave the tissue
    TiePlan plan;
    Pose parting; ///< the driver's, off the tail that it has laid down
    TiePhase phase = TiePhase::Idle;
    bool wanted = false;
    int throws = 0;       ///< tied
    int way = 0;          ///< the part of the phase
    double angle = 0.0;   ///< [rad] by which the strand is wound
    double since = 0.0;   ///< [s] in this phase
    double still = 0.0;   ///< [s] since anything has moved
    double drawn = 0.0;   ///< [m] by which the driver has moved away in the last step, to draw at the tail
    double pulled = 0.0;  ///< [N] at the tail, before that step
    double stiff = 0.0;   ///< [N/m] what the last steps have gained at the tail, for their way
    double largest = 0.0; ///< [N]
    Published<Told> told;
};

} // namespace filasofia::prefab
