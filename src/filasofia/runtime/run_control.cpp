#include "filasofia/runtime/run_control.h"

#include <utility>

namespace filasofia::runtime {

void RunControl::end()
{
    const std::lock_guard lock(mutex_);
    reason_.clear();
    stop_.store(false);
    running_.store(false);
}

void RunControl::finish(std::string why)
{
    const std::lock_guard lock(mutex_);
    if (reason_.empty()) reason_ = std::move(why);
    stop_.store(true);
}

std::string RunControl::reason() const
{
    const std::lock_guard lock(mutex_);
    return reason_;
}

} // namespace filasofia::runtime
