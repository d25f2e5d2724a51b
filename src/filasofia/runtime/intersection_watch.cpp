#include "filasofia/runtime/intersection_watch.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {

bool IntersectionWatch::observe(const std::vector<physics::Intersection>& now,
                                const std::function<bool(std::unique_ptr<IntersectionEvent>)>& post)
{
    if (now.empty() && before_.empty()) return true;
    const auto pairOf = [](const physics::Intersection& each) { return std::pair(each.first, each.second); };
    bool all = true;
    // Posts those that the other list lacks.
    const auto postNew = [&](const auto& these, const auto& others, IntersectionEvent::Kind kind) {
        for (const physics::Intersection& each : these) {
            if (std::ranges::binary_search(others, pairOf(each), {}, pairOf)) continue;
            auto event = std::make_unique<IntersectionEvent>();
            event->kind = kind;
            event->intersection = each;
            all = post(std::move(event)) && all;
        }
    };
    postNew(before_, now, IntersectionEvent::Kind::End);
    postNew(now, before_, IntersectionEvent::Kind::Begin);
    before_ = now;
    return all;
}

} // namespace filasofia::runtime
