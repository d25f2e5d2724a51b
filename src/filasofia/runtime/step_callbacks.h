#pragma once

#include <functional>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// The functions given to Simulation::everyStep(). The stepping thread's while a run goes on.
class StepCallbacks {
public:
    void add(std::function<void(double)> callback) { callbacks_.push_back(std::move(callback)); }
    /// Calls all in the order of add(), with the simulated time [s] at which the step ends. A callback that throws is
    /// logged and not called again.
    void call(double end);

    /// Why callbacks are no longer called, one for each.
    [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }

private:
    std::vector<std::function<void(double)>> callbacks_; ///< an empty one threw
    std::vector<std::string> problems_;
};

} // namespace filasofia::runtime
