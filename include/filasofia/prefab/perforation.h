#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <memory>
#include <vector>

namespace filasofia::prefab {

/// What may go through a wall: a point of a rigid element.
struct PiercingTool {
    BodyId body = {};
    int element = 0; ///< [-], >= 0
    Vec3 tip = {};   ///< [m], in the element's coordinates; as far behind the tool's end as it may press tissue in
};
constexpr auto fields(const PiercingTool*)
{
    using T = PiercingTool;
    return describe("PiercingTool", field("body", &T::body, "which"),
                    field("element", &T::element, "-", nonNegative(), "of the body"),
                    field("tip", &T::tip, "m", finite(), "in the element's coordinates"));
}

struct PerforationDef {
    BodyId wall = {};                     ///< a soft body
    std::vector<PiercingTool> tools = {}; ///< at least one
    double force = 10.0;                  ///< [N], > 0, of all tools on the wall: one that presses harder is through
    double smoothing = 0.02;              ///< [s], in (0, 10]: of that force's mean
    MetricTracker* tracker = nullptr;     ///< gets a Perforation each time, with the force [N]
    /// Told each time, on the stepping thread: where the tool was, and the force. Not a field of files.
    std::function<void(Vec3 place, double force)> perforated = {};
};
constexpr auto fields(const PerforationDef*)
{
    using T = PerforationDef;
    return describe("PerforationDef", field("wall", &T::wall, "a soft body"),
                    field("tools", &T::tools, "what may go through it"),
                    field("force", &T::force, "N", positive(), "one that presses harder is through"),
                    field("smoothing", &T::smoothing, "s", openClosed(0, 10), "of the mean"));
}

/// Tells when a tool has gone into a wall: its tip lies inside the tissue, or the tools press harder than the wall
/// stands. It is over when neither was so for half a second; then it may happen again. While it lasts the picture says
/// so. The wall itself stays whole: only blades and too much stress open tissue. Of a wall that was cut the tetrahedra
/// that it began with are asked.
class PerforationWatch {
public:
    /// Before a run. Throws Error where the Def is wrong.
    PerforationWatch(runtime::Simulation& simulation, PerforationDef def);

    [[nodiscard]] int count() const; ///< [-], how often so far; any thread

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
