#include "filasofia/engine/piercing/line.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/scene/line_radius.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {

LineShape::LineShape(const Scene& scene, const ThreadedLine& line) : id_(line.body), reversed_(line.reversed)
{
    const BodyPlace place = *findBody(scene, line.body);
    soft_ = place.soft;
    body_ = place.index;
    radius_ = lineRadius(scene, id_);
    places_.push_back(line.start);
    if (soft_) {
        const SoftBody& rod = scene.soft[body_];
        sharp_ = rod.model.rod.needle;
        first_ = line.first;
        nodes_ = rod.state.x.size();
        corners_.push_back(rod.state.x[nodeAt(0)]);
        for (std::size_t k = 1; first_ + k < nodes_ && !cutOff_; ++k) { // a ring has one edge more, which closes it
            const std::size_t edge = std::min(nodeAt(k - 1), nodeAt(k));
            cutOff_ = isCut(rod.model.rod, edge);
            if (cutOff_) continue;
            corners_.push_back(rod.state.x[nodeAt(k)]);
            places_.push_back(places_.back() + rod.model.rod.edges[edge].restLength);
        }
        FILASOFIA_ASSERT(places_.size() > 1); // a node alone is no line
        return;
    }
    const RigidBody& rigid = scene.rigid[body_];
    const Needle& needle = *rigid.model.needle;
    element_ = needle.element;
    for (Vec3 each : needle.points) corners_.push_back(transform(rigid.state.poses[element_], each));
    for (std::size_t i = 1; i < needle.points.size(); ++i)
        places_.push_back(places_.back() + length(needle.points[i] - needle.points[i - 1]));
}

std::size_t LineShape::nodeAt(std::size_t corner) const
{
    return reversed_ ? nodes_ - 1 - first_ - corner : first_ + corner;
}

bool LineShape::hasNode(int node) const
{
    const auto [low, high] = std::minmax({nodeAt(0), nodeAt(corners_.size() - 1)});
    return static_cast<std::size_t>(node) >= low && static_cast<std::size_t>(node) <= high;
}

std::size_t LineShape::segmentAt(double place) const
{
    const auto after = std::upper_bound(places_.begin(), places_.end(), place) - places_.begin();
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(places_) - 2));
}

double LineShape::along(std::size_t segment, Vec3 x) const
{
    const Vec3 from = corners_[segment], edge = corners_[segment + 1] - from;
    const double squared = lengthSquared(edge);
    return squared > 0.0 ? dot(x - from, edge) / squared : 0.0;
}

double LineShape::distanceSquared(std::size_t segment, Vec3 x) const
{
    const double t = std::clamp(along(segment, x), 0.0, 1.0);
    return lengthSquared(x - (corners_[segment] + t * (corners_[segment + 1] - corners_[segment])));
}

double LineShape::placeOn(std::size_t segment, Vec3 x) const
{
    double t = along(segment, x);
    if (segment > 0) t = std::max(t, 0.0);
    if (segment + 2 < places_.size()) t = std::min(t, 1.0);
    return places_[segment] + t * (places_[segment + 1] - places_[segment]);
}

double LineShape::nearest(Vec3 x, double guess) const
{
    std::size_t best = segmentAt(guess);
    double least = distanceSquared(best, x);
    for (bool better = true; better;) {
        better = false;
        for (const std::ptrdiff_t step : {-1, 1}) {
            const std::ptrdiff_t next = static_cast<std::ptrdiff_t>(best) + step;
            if (next < 0 || next + 1 >= std::ssize(corners_)) continue;
            const double there = distanceSquared(static_cast<std::size_t>(next), x);
            if (!(there < least)) continue;
            best = static_cast<std::size_t>(next);
            least = there;
            better = true;
        }
    }
    return placeOn(best, x);
}

double LineShape::nearest(Vec3 x) const
{
    std::size_t best = 0;
    double least = distanceSquared(0, x);
    for (std::size_t each = 1; each + 1 < corners_.size(); ++each)
        if (const double there = distanceSquared(each, x); there < least) {
            best = each;
            least = there;
        }
    return placeOn(best, x);
}

Vec3 LineShape::position(double place) const
{
    const std::size_t s = segmentAt(place);
    const double t = (place - places_[s]) / (places_[s + 1] - places_[s]);
    return corners_[s] + t * (corners_[s + 1] - corners_[s]);
}

Vec3 LineShape::forward(double place) const
{
    const std::size_t s = segmentAt(place);
    const double t = std::clamp((place - places_[s]) / (places_[s + 1] - places_[s]), 0.0, 1.0);
    const Vec3 mean = (1.0 - t) * forwardAtCorner(s) + t * forwardAtCorner(s + 1);
    return length(mean) > 0.1 ? normalized(mean) : normalized(corners_[s] - corners_[s + 1]);
}

Vec3 LineShape::forwardAtCorner(std::size_t corner) const
{
    const auto along = [&](std::size_t s) { return normalized(corners_[s] - corners_[s + 1]); };
    if (corner == 0) return along(0);
    if (corner + 1 == corners_.size()) return along(corner - 1);
    const Vec3 sum = along(corner - 1) + along(corner);
    return length(sum) > 0.1 ? normalized(sum) : along(corner); // folded: it has no mean
}

LineShape::Beside LineShape::beside(const BodyPoint& point) const
{
    if (!soft_) {
        const double place = nearest(point.position);
        return {place, length(point.position - position(std::clamp(place, begin(), end())))};
    }
    Beside at{0.0, radius_}; // on the surface of the rod
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k) {
        const auto node = static_cast<std::size_t>(point.nodes[k]);
        at.place += point.weights[k] * places_[reversed_ ? nodes_ - 1 - first_ - node : node - first_];
    }
    return at;
}

BodyPoint LineShape::pointAt(double place, const Scene& scene, const RigidPlan& plan) const
{
    BodyPoint point;
    point.position = position(place);
    if (!soft_) {
        point.of = BodyPoint::Of::Rigid;
        const auto isHere = [&](const RigidPlanElement& each) {
            return each.body == body_ && each.element == element_;
        };
        const RigidPlanElement& planned = *std::ranges::find_if(plan, isHere);
        point.body = static_cast<std::size_t>(&planned - plan.data());
        point.velocity = planned.velocity + cross(planned.angularVelocity, point.position - planned.centre);
        return point;
    }
    point.of = BodyPoint::Of::Soft;
    point.body = body_;
    const std::size_t s = segmentAt(place);
    const double t = std::clamp((place - places_[s]) / (places_[s + 1] - places_[s]), 0.0, 1.0);
    const std::vector<Vec3>& v = scene.soft[body_].state.v;
    for (const auto& [corner, weight] : {std::pair{s, 1.0 - t}, {s + 1, t}}) {
        const std::size_t node = nodeAt(corner);
        point.add(static_cast<int>(node), weight);
        point.velocity += weight * v[node];
    }
    return point;
}

LineShapes::LineShapes(const Scene& scene, const Channel& channel)
{
    for (const ThreadedLine& line : channel.lines)
        if (findBody(scene, line.body)) lines_.emplace_back(scene, line);
}

std::size_t LineShapes::indexAt(double place) const
{
    std::size_t i = 0;
    while (i + 1 < lines_.size() && place >= lines_[i + 1].begin()) ++i;
    return i;
}

const LineShape* LineShapes::find(BodyId body) const
{
    const auto found = std::ranges::find(lines_, body, &LineShape::body);
    return found == lines_.end() ? nullptr : &*found;
}

const LineShape& LineShapes::at(double place) const { return lines_[indexAt(place)]; }

double LineShapes::nearest(Vec3 x, double guess) const
{
    std::size_t i = indexAt(guess);
    double place = lines_[i].nearest(x, guess);
    // A place beyond the end of a line is on the next one. What is in between, where they are tied, is at its front.
    for (; place > lines_[i].end() && i + 1 < lines_.size(); ++i)
        place = std::max(lines_[i + 1].nearest(x, lines_[i + 1].begin()), lines_[i + 1].begin());
    for (; place < lines_[i].begin() && i > 0; --i)
        place = std::min(lines_[i - 1].nearest(x, lines_[i - 1].end()), lines_[i - 1].end());
    return place;
}

} // namespace filasofia::engine
