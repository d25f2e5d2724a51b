#include "filasofia/runtime/memory_list.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
namespace {

const std::any& copyOf(const Memories& saved, const std::string& of)
{
    static const std::any nothing;
    const auto found = saved.find(of);
    return found == saved.end() ? nothing : found->second;
}

} // namespace

void MemoryList::add(Memory memory)
{
    const std::string name = memory.of;
    for (int number = 2; std::ranges::find(all_, memory.of, &Memory::of) != all_.end(); ++number)
        memory.of = text(name, " (", number, ")");
    all_.push_back(std::move(memory));
}

Memories MemoryList::save() const
{
    Memories saved;
    for (const Memory& each : all_)
        if (std::any copy = each.save(); copy.has_value()) saved.emplace(each.of, std::move(copy));
    return saved;
}

void MemoryList::check(const Memories& saved) const
{
    for (const Memory& each : all_) {
        const std::any &copy = copyOf(saved, each.of), now = each.save();
        if (!now.has_value()) continue; // it is gone
        if (copy.has_value() && copy.type() != now.type()) fail("restore: the state has another kind of ", each.of);
        if (each.check)
            each.check(copy);
        else if (!copy.has_value())
            fail("restore: the state knows nothing of ", each.of);
    }
}

void MemoryList::restore(const Memories& saved) const
{
    for (const Memory& each : all_)
        if (const std::any& copy = copyOf(saved, each.of); copy.has_value() || each.check) each.restore(copy);
}

} // namespace filasofia::runtime
