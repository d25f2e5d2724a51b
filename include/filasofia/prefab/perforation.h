#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <memory>
#include <vector>

namespace filasofia::prefab {

/// A point of a rigid element that may pierce a wall.
struct PiercingTool {
    BodyId body = {};
    int element = 0; ///< [-], >= 0
    /// [m], in the element's coordinates; behind the tool's end by as much as the tool may press tissue in.
    Vec3 tip = {};
};
constexpr auto fields(const PiercingTool*)
{
    using T = PiercingTool;
    return describe("PiercingTool", field("body", &T::body, "the body"),
                    field("element", &T::element, "-", nonNegative(), "index in the body"),
                    field("tip", &T::tip, "m", finite(), "in the element's coordinates"));
}

struct PerforationDef {
    BodyId wall = {};                     ///< a soft body
    std::vector<PiercingTool> tools = {}; ///< at least one
    double force = 10.0;     ///< [N], > 0, total force of the tools on the wall; a larger one counts as perforation
    double smoothing = 0.02; ///< [s], in (0, 10], time constant of that force's mean
    MetricTracker* tracker = nullptr; ///< gets a Perforation event each time, with the force [N]
    /// Called each time on the stepping thread, with the tool's place and the force. Not a field of files.
    std::function<void(Vec3 place, double force)> perforated = {};
};
constexpr auto fields(const PerforationDef*)
{
    using T = PerforationDef;
    return describe("PerforationDef", field("wall", &T::wall, "a soft body"),
                    field("tools", &T::tools, "points that may pierce it"),
                    field("force", &T::force, "N", positive(), "a larger force counts as perforation"),
                    field("smoothing", &T::smoothing, "s", openClosed(0, 10), "time constant of the mean"));
}

/// Detects that a tool perforates a wall: its tip lies inside the tissue, or the tools press harder than `force`. The
/// perforation is over after neither was true for half a second; then a new one can happen. While it lasts the picture
/// says so. The wall itself stays whole: only blades and too much stress open tissue. If the wall was cut, the
/// tetrahedra that it began with are tested.
class PerforationWatch {
public:
    /// Construct it before a run. Throws an Error if the Def is wrong.
    PerforationWatch(runtime::Simulation& simulation, PerforationDef def);

    [[nodiscard]] int count() const; ///< [-], perforations so far; any thread

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
