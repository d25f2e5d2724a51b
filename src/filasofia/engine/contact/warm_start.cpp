#include "filasofia/engine/contact/warm_start.h"

#include "filasofia/geometry/bvh.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

auto key(const ContactMemory& memory) { return std::tuple(memory.first, memory.second, memory.feature); }
auto bodiesOf(const ContactMemory& memory) { return std::tuple(memory.first, memory.second); }

class Inheritance {
public:
    explicit Inheritance(const std::vector<ContactMemory>& memories) : memories_(memories), taken_(memories.size()) {}

    void bySameFeatures(ContactMemory& contact)
    {
        const auto found = std::lower_bound(memories_.begin(), memories_.end(), contact,
                                            [](const auto& a, const auto& b) { return key(a) < key(b); });
        if (found != memories_.end() && key(*found) == key(contact))
            take(static_cast<std::size_t>(found - memories_.begin()), contact);
    }

    /// To be called before byPlace(): a tree for every pair of bodies, over what nobody has taken.
    void plantTrees()
    {
        std::vector<geometry::Box> boxes;
        for (std::size_t i = 0; i < memories_.size();) {
            Tree tree{i, {}, {}};
            boxes.clear();
            for (; i < memories_.size() && bodiesOf(memories_[i]) == bodiesOf(memories_[tree.first]); ++i) {
                if (taken_[i]) continue;
                tree.left.push_back(i);
                boxes.push_back({memories_[i].point, memories_[i].point});
            }
            if (tree.left.empty()) continue;
            tree.places = geometry::Bvh(boxes);
            trees_.push_back(std::move(tree));
        }
    }

    void byPlace(double within, ContactMemory& contact)
    {
        const auto bodies = [&](const Tree& tree) { return bodiesOf(memories_[tree.first]); };
        const auto tree = std::ranges::lower_bound(trees_, bodiesOf(contact), {}, bodies);
        if (tree == trees_.end() || bodies(*tree) != bodiesOf(contact)) return;
        const auto squaredDistance = [&](int i) {
            const std::size_t memory = tree->left[static_cast<std::size_t>(i)];
            return taken_[memory] ? std::numeric_limits<double>::infinity()
                                  : lengthSquared(memories_[memory].point - contact.point);
        };
        const int nearest = tree->places.nearest(contact.point, squaredDistance, within * within).primitive;
        if (nearest >= 0) take(tree->left[static_cast<std::size_t>(nearest)], contact);
    }

private:
    struct Tree {
        std::size_t first;             ///< memory of the two bodies
        std::vector<std::size_t> left; ///< memories, ascending
        geometry::Bvh places;
    };

    void take(std::size_t memory, ContactMemory& contact)
    {
        taken_[memory] = true;
        contact.force = memories_[memory].force;
    }

    const std::vector<ContactMemory>& memories_;
    std::vector<bool> taken_;
    std::vector<Tree> trees_; ///< ascending by bodies
};

/// Which way two contacts push the same body, the one's cosine with the other: of the same two bodies, or of tissue
/// that two others have between them. 1: no body that they could contradict each other about.
double agreement(const Coupling& coupling, std::size_t a, std::size_t b)
{
    const ContactMemory &one = coupling.contacts[a].memory, &two = coupling.contacts[b].memory;
    const double cosine = dot(coupling.links[a].frame[0], coupling.links[b].frame[0]);
    if (bodiesOf(one) == bodiesOf(two)) return cosine;
    const auto isSoft = [](const Link& link, std::size_t side) { return link.sides[side].of == BodyPoint::Of::Soft; };
    const std::array ones{one.first, one.second}, twos{two.first, two.second};
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k)
            if (ones[i] == twos[k] && isSoft(coupling.links[a], i)) return i == k ? cosine : -cosine;
    return 1.0;
}

constexpr double kOpposite = -0.9;  ///< [-] cosine between normals
constexpr double kNearBy = 10.0;    ///< [-] how far contacts that push opposite ways may be apart, over their depth
constexpr double kSamePlace = 1e-3; ///< [m] besides the way that the two may have gone since

} // namespace

void inheritForces(double dt, const std::vector<ContactMemory>& memories, Coupling& coupling)
{
    if (memories.empty()) return;
    Inheritance inheritance(memories);
    for (FoundContact& contact : coupling.contacts) inheritance.bySameFeatures(contact.memory);
    inheritance.plantTrees();
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c) {
        const Link& link = coupling.links[c];
        const double way = dt * (length(link.sides[0].velocity) + length(link.sides[1].velocity));
        if (ContactMemory& memory = coupling.contacts[c].memory; memory.force == Vec3{})
            inheritance.byPlace(kSamePlace + way, memory);
    }
}

std::vector<bool> contradicted(const Coupling& coupling)
{
    std::vector<bool> contradicted(coupling.contacts.size());
    std::vector<std::size_t> deep; // those that push and are inside each other, ascending by x
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c)
        if (coupling.contacts[c].gap < 0.0 && coupling.links[c].next.x > 0.0) deep.push_back(c);
    const auto at = [&](std::size_t c) { return coupling.contacts[c].memory.point; };
    std::ranges::sort(deep, {}, [&](std::size_t c) { return std::pair(at(c).x, c); });
    double deepest = 0.0;
    for (const std::size_t c : deep) deepest = std::max(deepest, -coupling.contacts[c].gap);
    for (std::size_t i = 0; i < deep.size(); ++i)
        for (std::size_t j = i + 1; j < deep.size() && at(deep[j]).x - at(deep[i]).x < 2.0 * kNearBy * deepest; ++j) {
            const FoundContact& a = coupling.contacts[deep[i]];
            const FoundContact& b = coupling.contacts[deep[j]];
            if (agreement(coupling, deep[i], deep[j]) > kOpposite) continue;
            const Vec3 normal = coupling.links[deep[i]].frame[0], apart = a.memory.point - b.memory.point;
            const double depth = -a.gap - b.gap;
            if (std::abs(dot(apart, normal)) > depth || length(apart) > kNearBy * depth) continue;
            contradicted[deep[i]] = contradicted[deep[j]] = true;
        }
    return contradicted;
}

void sortMemories(std::vector<ContactMemory>& memories)
{
    std::sort(memories.begin(), memories.end(), [](const auto& a, const auto& b) { return key(a) < key(b); });
}

void forgetSurface(SurfaceName name, State& state)
{
    std::erase_if(state.sides, [&](const SideKept& kept) { return kept.source == name || kept.target == name; });
    std::erase_if(state.contacts, [&](const ContactMemory& memory) {
        const FeaturePair pair = featurePair(memory.feature);
        return SurfaceName{memory.first, pair.models[0]} == name || SurfaceName{memory.second, pair.models[1]} == name;
    });
}

} // namespace filasofia::engine
