#pragma once

#include "filasofia/physics/step.h"
#include "filasofia/runtime/intersection_event.h"

#include <functional>
#include <memory>
#include <vector>

namespace filasofia::runtime {

/// Makes events of the changes in StepReport::intersections. Used by the stepping thread.
class IntersectionWatch {
public:
    /// Returns false if `post` did for one of the events.
    bool observe(const std::vector<physics::Intersection>& now,
                 const std::function<bool(std::unique_ptr<IntersectionEvent>)>& post);

private:
    std::vector<physics::Intersection> before_; ///< ascending by their bodies, as in reports
};

} // namespace filasofia::runtime
