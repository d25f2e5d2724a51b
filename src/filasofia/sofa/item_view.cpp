#include "filasofia/sofa/item_view.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::vec_id::read_access::position;
using ::sofa::core::vec_id::read_access::velocity;

std::array<double, 3> keyOf(Vec3 place) { return {place.x, place.y, place.z}; }

/// A face of one tetrahedron only, and the node behind it.
struct OuterFace {
    geometry::Triangle nodes = {};
    int behind = -1;
};
std::vector<OuterFace> outerFaces(const std::vector<geometry::Tetrahedron>& tetrahedra)
{
    std::map<geometry::Triangle, int> uses;
    const auto each = [&](const auto& act) {
        for (const geometry::Tetrahedron& t : tetrahedra)
            for (std::size_t f = 0; f < 4; ++f) {
                const auto& corners = geometry::kTetrahedronFaces[f];
                const OuterFace face{{t[at(corners[0])], t[at(corners[1])], t[at(corners[2])]}, t[f]};
                geometry::Triangle key = face.nodes;
                std::ranges::sort(key);
                act(face, key);
            }
    };
    each([&](const OuterFace&, const geometry::Triangle& key) { ++uses[key]; });
    std::vector<OuterFace> faces;
    each([&](const OuterFace& face, const geometry::Triangle& key) {
        if (uses[key] == 1) faces.push_back(face);
    });
    return faces;
}

} // namespace

ItemView::ItemView(LoadedItem item, double unit, bool cut) : item_(std::move(item)), unit_(unit)
{
    if (item_.rigid) {
        lookAtRigid();
        return;
    }
    sofaRest_ = restOf(*item_.soft, unit_);
    elements_ = elementsOf(*item_.soft, sofaRest_);
    sources_ = item_.vertices;
    if (sources_.empty()) {
        sources_.resize(sofaRest_.size());
        std::iota(sources_.begin(), sources_.end(), 0);
    }
    numbers_.assign(sofaRest_.size(), -1);
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        const Vec3 place = sofaRest_[at(sources_[n])];
        rest_.push_back(place);
        firsts_.emplace(keyOf(place), static_cast<int>(n));
        if (numbers_[at(sources_[n])] < 0) numbers_[at(sources_[n])] = static_cast<int>(n);
    }
    places_ = rest_;
    speeds_.resize(rest_.size());
    for (const OuterFace& face : outerFaces(elements_.tetrahedra)) skin_.insert(skinKey(face.nodes));
    if (cut) writeBoundary(sofaRest_);
    look();
}

int ItemView::nodeCount() const { return static_cast<int>(item_.rigid ? rigid_.poses.size() : places_.size()); }

void ItemView::lookAtRigid()
{
    const auto& x = item_.rigid->read(position)->getValue();
    const auto& v = item_.rigid->read(velocity)->getValue();
    // The number of elements is the one that its Def has.
    rigid_.poses.resize(std::get<physics::RigidBodyDef>(item_.def).elements.size());
    rigid_.velocities.assign(rigid_.poses.size(), {});
    rigid_.angularVelocities.assign(rigid_.poses.size(), {});
    for (std::size_t i = 0; i < std::min<std::size_t>(x.size(), rigid_.poses.size()); ++i) {
        rigid_.poses[i] = {unit_ * fromSofa(x[i].getCenter()), fromSofa(x[i].getOrientation())};
        if (i >= v.size()) continue;
        rigid_.velocities[i] = unit_ * fromSofa(getVCenter(v[i]));
        rigid_.angularVelocities[i] = fromSofa(getVOrientation(v[i]));
    }
}

void ItemView::look()
{
    if (item_.rigid) {
        lookAtRigid();
        return;
    }
    const auto& x = item_.soft->read(position)->getValue();
    ItemElements now =
        elementsOf(*item_.soft, item_.picture ? placesOf(*item_.soft, unit_) : restOf(*item_.soft, unit_));
    if (now != elements_ || x.size() != sofaRest_.size()) follow(std::move(now));
    const auto* speeds = item_.picture ? nullptr : item_.soft->read(velocity); // pictures have no velocities
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        speeds_[n] = {};
        if (sources_[n] < 0 || at(sources_[n]) >= x.size()) continue;
        places_[n] = unit_ * fromSofa(x[at(sources_[n])]);
        if (speeds && at(sources_[n]) < speeds->getValue().size())
            speeds_[n] = unit_ * fromSofa(speeds->getValue()[at(sources_[n])]);
    }
}

void ItemView::follow(ItemElements now)
{
    const std::vector<Vec3> rest = restOf(*item_.soft, unit_);
    elements_ = std::move(now);
    renumber(rest);
    ++revision_;
    writeBoundary(rest);
    sofaRest_ = rest;
}

/// Finds where SOFA has its old nodes now, by their places at rest.
void ItemView::renumber(const std::vector<Vec3>& rest)
{
    std::vector<int> moved(sofaRest_.size(), -1); // from the old index to the new one
    if (!item_.picture) {
        std::multimap<Key, int> lost;
        for (std::size_t i = 0; i < sofaRest_.size(); ++i)
            if (i < rest.size() && rest[i] == sofaRest_[i])
                moved[i] = static_cast<int>(i);
            else
                lost.emplace(keyOf(sofaRest_[i]), static_cast<int>(i));
        for (std::size_t j = 0; j < rest.size(); ++j) {
            if (j < moved.size() && moved[j] == static_cast<int>(j)) continue;
            const auto found = lost.find(keyOf(rest[j]));
            if (found == lost.end()) continue; // a new one
            moved[at(found->second)] = static_cast<int>(j);
            lost.erase(found);
        }
    }
    numbers_.assign(rest.size(), -1);
    for (std::size_t n = 0; n < sources_.size(); ++n) {
        if (sources_[n] >= 0) sources_[n] = moved[at(sources_[n])];
        if (sources_[n] >= 0 && numbers_[at(sources_[n])] < 0) numbers_[at(sources_[n])] = static_cast<int>(n);
    }
    if (!item_.picture) return;
    // The vertices of a picture: those of its faces, from 0 on.
    std::size_t next = 0;
    for (const geometry::Triangle& t : elements_.triangles)
        for (const int corner : t) {
            if (numbers_[at(corner)] >= 0) continue;
            if (next == sources_.size()) break;
            numbers_[at(corner)] = static_cast<int>(next);
            rest_[next] = rest[at(corner)];
            sources_[next++] = corner;
        }
}

/// The node of one of SOFA's; a new one if it has none.
int ItemView::nodeAt(int source, const std::vector<Vec3>& rest)
{
    int& node = numbers_[at(source)];
    if (node >= 0) return node;
    node = static_cast<int>(sources_.size());
    sources_.push_back(source);
    rest_.push_back(rest[at(source)]);
    places_.push_back(rest[at(source)]);
    speeds_.emplace_back();
    firsts_.emplace(keyOf(rest[at(source)]), node);
    return node;
}

geometry::Triangle ItemView::skinKey(const geometry::Triangle& nodes) const
{
    geometry::Triangle key{};
    for (std::size_t i = 0; i < 3; ++i) key[i] = firsts_.at(keyOf(rest_[at(nodes[i])]));
    std::ranges::sort(key);
    return key;
}

void ItemView::writeBoundary(const std::vector<Vec3>& rest)
{
    auto boundary = std::make_shared<frame::Boundary>();
    boundary->revision = revision_;
    const auto add = [&](const geometry::Triangle& t, int behind) {
        const geometry::Triangle nodes{nodeAt(t[0], rest), nodeAt(t[1], rest), nodeAt(t[2], rest)};
        boundary->triangles.push_back(nodes);
        boundary->behind.push_back(behind < 0 ? -1 : nodeAt(behind, rest));
        boundary->opened.push_back(behind >= 0 && !skin_.contains(skinKey(nodes)) ? 1 : 0);
    };
    for (const OuterFace& face : outerFaces(elements_.tetrahedra)) add(face.nodes, face.behind);
    if (elements_.tetrahedra.empty())
        for (const geometry::Triangle& t : tidied(elements_.triangles, rest)) add(t, -1);
    boundary->rest = rest_;
    boundary_ = std::move(boundary);
}

void ItemView::write(BodyId id, frame::SoftBodyFrame& out) const
{
    out = {.id = id, .positions = places_, .velocities = speeds_, .boundary = boundary_};
}

} // namespace filasofia::sofaengine
