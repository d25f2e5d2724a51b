#include "filasofia/engine/contact_memory.h"

#include <algorithm>
#include <tuple>

namespace filasofia::engine {
namespace {

auto key(const ContactMemory& memory) { return std::tuple(memory.first, memory.second, memory.feature); }

class Inheritance {
public:
    explicit Inheritance(const std::vector<ContactMemory>& memories) : memories_(memories), taken_(memories.size()) {}

    void bySameFeatures(ContactMemory& contact)
    {
        const auto found = std::lower_bound(memories_.begin(), memories_.end(), contact,
                                            [](const auto& a, const auto& b) { return key(a) < key(b); });
        if (found != memories_.end() && key(*found) == key(contact)) take(found, contact);
    }
    void byPlace(double within, ContactMemory& contact)
    {
        const auto bodies = [](const ContactMemory& m) { return std::tuple(m.first, m.second); };
        auto at = std::lower_bound(memories_.begin(), memories_.end(), contact,
                                   [&](const auto& a, const auto& b) { return bodies(a) < bodies(b); });
        auto nearest = memories_.end();
        for (double least = within * within; at != memories_.end() && bodies(*at) == bodies(contact); ++at) {
            const double distance = lengthSquared(at->point - contact.point);
            if (!(distance < least) || taken_[static_cast<std::size_t>(at - memories_.begin())]) continue;
            least = distance;
            nearest = at;
        }
        if (nearest != memories_.end()) take(nearest, contact);
    }

private:
    void take(std::vector<ContactMemory>::const_iterator from, ContactMemory& contact)
    {
        taken_[static_cast<std::size_t>(from - memories_.begin())] = true;
        contact.force = from->force;
    }

    const std::vector<ContactMemory>& memories_;
    std::vector<bool> taken_;
};

constexpr double kSamePlace = 1e-3; ///< [m] besides the way that the two may have gone since

} // namespace

void inheritForces(double dt, const std::vector<ContactMemory>& memories, Coupling& coupling)
{
    if (memories.empty()) return;
    Inheritance inheritance(memories);
    for (FoundContact& contact : coupling.contacts) inheritance.bySameFeatures(contact.memory);
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c) {
        const Link& link = coupling.links[c];
        const double way = dt * (length(link.sides[0].velocity) + length(link.sides[1].velocity));
        if (ContactMemory& memory = coupling.contacts[c].memory; memory.force == Vec3{})
            inheritance.byPlace(kSamePlace + way, memory);
    }
}

void sortMemories(std::vector<ContactMemory>& memories)
{
    std::sort(memories.begin(), memories.end(), [](const auto& a, const auto& b) { return key(a) < key(b); });
}

} // namespace filasofia::engine
