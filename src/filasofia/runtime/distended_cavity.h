#pragma once

#include "filasofia/runtime/electrodes.h"

#include "filasofia/surface/distension.h"

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace filasofia::visual {
class VisualBody;
class VisualServer;
} // namespace filasofia::visual

namespace filasofia::runtime {

/// The fluid that distends a cavity. It steps on the stepping thread: it has some dozen bubbles.
class DistendedCavity {
public:
    /// Any thread. Error as Simulation::addDistension().
    void add(const surface::DistensionDef& def, Vec3 gravity);
    [[nodiscard]] bool any() const { return any_; }
    /// Any thread. Error as Simulation::distend().
    void check(const surface::Distend& command) const;
    /// Takes effect at the fluid's next step. Any thread. Error as Simulation::distend().
    void apply(const surface::Distend& command);
    [[nodiscard]] surface::DistensionBalance balance() const; ///< any thread; Error without a fluid
    /// As it was added. Any thread.
    void restart();

    /// What clouds it.
    struct Sources {
        const Bleedings& bleedings;
        const Electrodes& electrodes;
    };
    /// After a step of physics that ended at `time` [s], and after those of heat and blood: the stepping thread.
    void afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Sources& sources);
    /// What an event is to tell, once. The stepping thread.
    [[nodiscard]] std::optional<surface::DistensionBalance> takeTold();
    void showAgain(); ///< in a picture that has nothing of it yet
    /// Draws what has changed since the last call.
    void draw(visual::VisualServer& visual);
    void fill(RunReport& report) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    /// The fluid, and what a step of it needs.
    struct Cavity {
        surface::Distension fluid;
        surface::Distension start; ///< as it was added
        Vec3 gravity = {};
        double last = -1.0;                       ///< [s], end of its last step; < 0: there was none
        double next = 0.0;                        ///< [s]
        double bled = 0.0;                        ///< [m^3], that had welled by its last step
        bool healing = false;                     ///< a reset is not yet known to the layers of blood
        std::map<std::size_t, double> given = {}; ///< [J], by electrodes, by then
        surface::DistensionBalance told = {};     ///< what the last event said
        double tellFrom = 0.0;                    ///< [s], no event before, unless the deficit gets too high
    };
    struct State {
        std::vector<Cavity> all = {}; ///< at most one
    };
    [[nodiscard]] const Cavity& cavity() const;
    static void heat(Cavity& cavity, const std::vector<Electrodes::Given>& given);
    static double welled(Cavity& cavity, double all);
    static bool mustTell(const Cavity& cavity);
    void drawBubbles(visual::VisualServer& visual, const std::vector<surface::Bubble>& bubbles);

    mutable std::mutex mutex_;
    State state_;
    std::optional<surface::DistensionBalance> told_; ///< takeTold() does not have it yet
    std::atomic<bool> any_ = false;                  ///< without a fluid a step costs nothing
    bool fresh_ = false;                             ///< draw() has not drawn it yet
    visual::VisualBody* bubbles_ = nullptr;          ///< in the picture; null: it has none yet
};

} // namespace filasofia::runtime
