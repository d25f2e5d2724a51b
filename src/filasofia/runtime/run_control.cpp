#include "filasofia/runtime/run_control.h"

#include <memory>
#include <utility>

namespace filasofia::runtime {

RunControl::~RunControl() { delete reason_.load(); }

void RunControl::end()
{
    delete reason_.exchange(nullptr);
    stop_.store(false);
    running_.store(false);
}

void RunControl::finish(std::string why)
{
    if (!why.empty()) {
        auto given = std::make_unique<const std::string>(std::move(why));
        const std::string* none = nullptr;
        if (reason_.compare_exchange_strong(none, given.get())) static_cast<void>(given.release());
    }
    stop_.store(true);
}

std::string RunControl::reason() const
{
    const std::string* given = reason_.load();
    return given ? *given : std::string();
}

void RunControl::goBack(std::string reason)
{
    delete reason_.exchange(nullptr);
    stop_.store(false);
    if (!reason.empty()) finish(std::move(reason));
}

} // namespace filasofia::runtime
