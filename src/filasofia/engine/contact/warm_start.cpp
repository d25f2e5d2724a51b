#include "filasofia/engine/contact/warm_start.h"

#include "filasofia/engine/collision/proximity.h"
#include "filasofia/geometry/bvh.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

auto key(const CachedContact& cached) { return std::tuple(cached.first, cached.second, cached.feature); }
auto bodiesOf(const CachedContact& cached) { return std::tuple(cached.first, cached.second); }

class Inheritance {
public:
    explicit Inheritance(const std::vector<CachedContact>& cache) : cache_(cache), taken_(cache.size()) {}

    void bySameFeatures(CachedContact& contact)
    {
        const auto found = std::lower_bound(cache_.begin(), cache_.end(), contact,
                                            [](const auto& a, const auto& b) { return key(a) < key(b); });
        if (found != cache_.end() && key(*found) == key(contact))
            take(static_cast<std::size_t>(found - cache_.begin()), contact);
    }

    /// Builds a tree per pair of bodies over the entries not yet taken. To be called before byPlace().
    void buildTrees()
    {
        std::vector<geometry::Box> boxes;
        for (std::size_t i = 0; i < cache_.size();) {
            Tree tree{i, {}, {}};
            boxes.clear();
            for (; i < cache_.size() && bodiesOf(cache_[i]) == bodiesOf(cache_[tree.first]); ++i) {
                if (taken_[i]) continue;
                tree.left.push_back(i);
                boxes.push_back({cache_[i].point, cache_[i].point});
            }
            if (tree.left.empty()) continue;
            tree.places = geometry::Bvh(boxes);
            trees_.push_back(std::move(tree));
        }
    }

    void byPlace(double within, CachedContact& contact)
    {
        const auto bodies = [&](const Tree& tree) { return bodiesOf(cache_[tree.first]); };
        const auto tree = std::ranges::lower_bound(trees_, bodiesOf(contact), {}, bodies);
        if (tree == trees_.end() || bodies(*tree) != bodiesOf(contact)) return;
        const auto squaredDistance = [&](int i) {
            const std::size_t cached = tree->left[static_cast<std::size_t>(i)];
            return taken_[cached] ? std::numeric_limits<double>::infinity()
                                  : lengthSquared(cache_[cached].point - contact.point);
        };
        const int nearest = tree->places.nearest(contact.point, squaredDistance, within * within).primitive;
        if (nearest >= 0) take(tree->left[static_cast<std::size_t>(nearest)], contact);
    }

private:
    struct Tree {
        std::size_t first;             ///< first entry of the two bodies
        std::vector<std::size_t> left; ///< entries, ascending
        geometry::Bvh places;
    };

    void take(std::size_t cached, CachedContact& contact)
    {
        taken_[cached] = true;
        contact.force = cache_[cached].force;
        contact.frictionLags = cache_[cached].frictionLags;
    }

    const std::vector<CachedContact>& cache_;
    std::vector<bool> taken_;
    std::vector<Tree> trees_; ///< ascending by bodies
};

/// The cosine between the directions in which two contacts push the same body: a body of the same pair, or tissue
/// between two other bodies. 1 if there is no such body.
double agreement(const Constraint& a, const Constraint& b)
{
    const CachedContact &one = a.contact.cached, &two = b.contact.cached;
    const double cosine = dot(a.frame[0], b.frame[0]);
    if (bodiesOf(one) == bodiesOf(two)) return cosine;
    const auto isSoft = [](const Constraint& contact, std::size_t side) {
        return contact.sides[side].of == BodyPoint::Of::Soft;
    };
    const std::array ones{one.first, one.second}, twos{two.first, two.second};
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k)
            if (ones[i] == twos[k] && isSoft(a, i)) return i == k ? cosine : -cosine;
    return 1.0;
}

constexpr double kOpposite = -0.9; ///< [-] cosine between normals
/// [-] maximum distance of contacts that push opposite ways, relative to their depth
constexpr double kNearBy = 10.0;
constexpr double kSameContact = 1e-3; ///< [m] besides the distance that both sides may have moved since

} // namespace

void inheritForces(double dt, const std::vector<CachedContact>& cache, std::span<Constraint> contacts)
{
    if (cache.empty()) return;
    Inheritance inheritance(cache);
    for (Constraint& each : contacts) inheritance.bySameFeatures(each.contact.cached);
    inheritance.buildTrees();
    for (Constraint& each : contacts) {
        const double way = dt * (length(each.sides[0].velocity) + length(each.sides[1].velocity));
        if (each.contact.cached.force == Vec3{}) inheritance.byPlace(kSameContact + way, each.contact.cached);
    }
}

std::vector<bool> contradicted(std::span<const Constraint> contacts)
{
    std::vector<bool> contradicted(contacts.size());
    std::vector<std::size_t> deep; // contacts that push and overlap, ascending by x
    const auto gapOf = [&](std::size_t c) { return contacts[c].contact.gap; };
    const auto at = [&](std::size_t c) { return contacts[c].contact.cached.point; };
    for (std::size_t c = 0; c < contacts.size(); ++c)
        if (gapOf(c) < 0.0 && contacts[c].multiplier.x > 0.0) deep.push_back(c);
    std::ranges::sort(deep, {}, [&](std::size_t c) { return std::pair(at(c).x, c); });
    double deepest = 0.0;
    for (const std::size_t c : deep) deepest = std::max(deepest, -gapOf(c));
    for (std::size_t i = 0; i < deep.size(); ++i)
        for (std::size_t j = i + 1; j < deep.size() && at(deep[j]).x - at(deep[i]).x < 2.0 * kNearBy * deepest; ++j) {
            const std::size_t a = deep[i], b = deep[j];
            if (agreement(contacts[a], contacts[b]) > kOpposite) continue;
            const Vec3 normal = contacts[a].frame[0], apart = at(a) - at(b);
            const double depth = -gapOf(a) - gapOf(b);
            if (std::abs(dot(apart, normal)) > depth || length(apart) > kNearBy * depth) continue;
            contradicted[a] = contradicted[b] = true;
        }
    return contradicted;
}

void sortCache(std::vector<CachedContact>& cache)
{
    std::sort(cache.begin(), cache.end(), [](const auto& a, const auto& b) { return key(a) < key(b); });
}

void forgetSurface(SurfaceName name, Scene& scene)
{
    std::erase_if(scene.sides, [&](const SheetSide& kept) { return kept.source == name || kept.target == name; });
    std::erase_if(scene.contacts, [&](const CachedContact& cached) {
        const FeaturePair pair = featurePair(cached.feature);
        return SurfaceName{cached.first, pair.models[0]} == name || SurfaceName{cached.second, pair.models[1]} == name;
    });
}

} // namespace filasofia::engine
