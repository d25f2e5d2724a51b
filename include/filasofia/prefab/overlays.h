#pragma once

#include "filasofia/prefab/task.h"

/// What a trainee sees over the picture.
namespace filasofia::prefab {

/// Tells the next step of a task in words, and points at its target with an arrow.
class Guidance {
public:
    /// Before a run. Ends before the task's simulation.
    Guidance(runtime::Simulation& simulation, const Task& task);
    /// Arrows are drawn on this server: from inside Simulation::dress; without it there are only words.
    void dress(visual::VisualServer& server);
    void setOn(bool on); ///< any thread; on from the start

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

struct ForceBarDef {
    std::string name = "Force";
    std::vector<BodyId> bodies =
        {};                  ///< at least one; what others do to them is added up, what they do to each other not
    double warning = 1.0;    ///< [N], > 0: the bar is red beyond
    double full = 2.0;       ///< [N], > warning, of a full bar
    double smoothing = 0.02; ///< [s], in (0, 10]: forces jump from step to step, their means do not
};
constexpr auto fields(const ForceBarDef*)
{
    using T = ForceBarDef;
    return describe("ForceBarDef", field("name", &T::name, "beside the bar"),
                    field("bodies", &T::bodies, "whose contacts and grasps count"),
                    field("warning", &T::warning, "N", positive(), "red beyond"),
                    field("full", &T::full, "N", positive(), "of a full bar"),
                    field("smoothing", &T::smoothing, "s", openClosed(0, 10), "of the mean"));
}

/// Shows how hard bodies press and pull at others, smoothed, and counts how often that was more than the warning: the
/// sum of the normal forces of their contacts, and of the forces of what they hold.
class ForceBar {
public:
    /// Before a run. Throws Error where the Def is wrong.
    ForceBar(runtime::Simulation& simulation, const ForceBarDef& def);

    // Any thread.
    [[nodiscard]] double force() const;   ///< [N], smoothed
    [[nodiscard]] double highest() const; ///< [N], smoothed, since the start
    [[nodiscard]] int
    warnings() const; ///< [-], times that it rose above the warning, after it had been below 80 % of it

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
