#pragma once

#include "filasofia/prefab/task.h"

/// What a trainee sees over the picture.
namespace filasofia::prefab {

/// Shows the instruction of a task's next step, and points at its target with an arrow.
class Guidance {
public:
    /// Construct it before a run. It ends before the task's simulation.
    Guidance(runtime::Simulation& simulation, const Task& task);
    /// Draws arrows on this server; call it from inside the function given to Simulation::dress(). Without it there are
    /// only instructions.
    void dress(visual::VisualServer& server);
    void setOn(bool on); ///< any thread; on from the start

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

struct ForceBarDef {
    std::string name = "Force";
    std::vector<BodyId> bodies = {}; ///< at least one; forces of others on them are summed, forces between them are not
    double warning = 1.0;            ///< [N], > 0, the bar is red above it
    double full = 2.0;               ///< [N], > warning, force of a full bar
    double smoothing = 0.02;         ///< [s], in (0, 10], time constant of the mean; forces jump from step to step
};
constexpr auto fields(const ForceBarDef*)
{
    using T = ForceBarDef;
    return describe("ForceBarDef", field("name", &T::name, "label of the bar"),
                    field("bodies", &T::bodies, "whose contacts and grasps count"),
                    field("warning", &T::warning, "N", positive(), "the bar is red above it"),
                    field("full", &T::full, "N", positive(), "force of a full bar"),
                    field("smoothing", &T::smoothing, "s", openClosed(0, 10), "time constant of the mean"));
}

/// Shows how hard bodies press and pull on others, smoothed: the sum of the normal forces of their contacts and of the
/// forces of what they hold. Counts how often that exceeds the warning.
class ForceBar {
public:
    /// Construct it before a run. Throws an Error if the Def is wrong.
    ForceBar(runtime::Simulation& simulation, const ForceBarDef& def);

    // Any thread.
    [[nodiscard]] double force() const;   ///< [N], smoothed
    [[nodiscard]] double highest() const; ///< [N], largest smoothed force since the start
    /// [-], how often the force rose above the warning, after it had been below 80 % of it.
    [[nodiscard]] int warnings() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

/// Shows the fluid that distends a cavity: pressure, flows, deficit, red if it is above its limit, and whether blood
/// clouds it.
class FluidPanel {
public:
    /// Construct it before a run, after Simulation::addDistension(): Error without a fluid.
    explicit FluidPanel(runtime::Simulation& simulation);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
