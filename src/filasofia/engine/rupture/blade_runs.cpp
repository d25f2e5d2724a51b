#include "filasofia/engine/rupture/blade_runs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace filasofia::engine {
namespace {

constexpr double kSliding =
    0.05; ///< [-] a segment whose direction is shorter, relative to the longest, moves along itself
constexpr double kSameLength = 1e-6; // [-]
constexpr double kNarrow = 2.0;      ///< [-] mean edges: a ring of a smaller hydraulic diameter has no inside
constexpr double kSharpest = -0.2;   ///< [-] cosine: normals beyond a joint that differ more belong to another run

struct SegmentEnd {
    Vec3 place;
    int segment, end;
};

} // namespace

void BladeRuns::join(std::span<const BladeSegment> blade, int pass, double meanEdge)
{
    // After a pause sides are kept. If another part of the body is near the tissue now, it has other lengths or another
    // number of segments; or it is straight, as jaws are, and has no sides.
    const bool same = std::ranges::equal(blade, stretches_, [](const BladeSegment& now, const Stretch& last) {
        const double l = distance(now.from, now.to);
        return std::abs(std::abs(last.to - last.from) - l) <= kSameLength * l;
    });
    pass_ = pass;
    const auto count = static_cast<int>(blade.size());
    std::vector<SegmentEnd> ends;
    for (int i = 0; i < count; ++i) {
        ends.push_back({blade[i].from, i, 0});
        ends.push_back({blade[i].to, i, 1});
    }
    std::ranges::sort(
        ends, {}, [](const SegmentEnd& e) { return std::tuple(e.place.x, e.place.y, e.place.z, e.segment, e.end); });
    joints_.assign(blade.size(), {});
    for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
        while (next < ends.size() && ends[next].place == ends[i].place) ++next;
        if (next - i != 2) continue;
        const SegmentEnd &a = ends[i], &b = ends[i + 1];
        joints_[a.segment][a.end] = {b.segment, b.end};
        joints_[b.segment][b.end] = {a.segment, a.end};
    }

    orderChains(blade);
    for (int i = 0; i < count; ++i)
        if (rings_[i] > 0.0 && widthOf(i, blade) < kNarrow * meanEdge) separate(i);
    if (directions_.size() != blade.size()) directions_.assign(blade.size(), {});
    if (!same) sides_.assign(blade.size(), 0);
}

/// Places the segments one after the other, along each chain.
void BladeRuns::orderChains(std::span<const BladeSegment> blade)
{
    const auto count = static_cast<int>(blade.size());
    along_.assign(blade.size(), 0.0);
    chains_.assign(blade.size(), -1);
    rings_.assign(blade.size(), 0.0);
    stretches_.assign(blade.size(), {});
    const auto place = [&](int segment, int chain, double along, double start) {
        const double l = distance(blade[segment].from, blade[segment].to);
        along_[segment] = along;
        chains_[segment] = chain;
        stretches_[segment].from = along > 0.0 ? start : start + l;
        stretches_[segment].to = along > 0.0 ? start + l : start;
    };
    for (int first = 0; first < count; ++first) {
        if (chains_[first] >= 0) continue;
        place(first, first, 1.0, 0.0);
        for (int start : {1, 0})
            for (int at = first, end = start;;) {
                const Joint next = joints_[at][end];
                if (next.segment < 0) break;
                const double here = end == 0 ? stretches_[at].from : stretches_[at].to;
                if (chains_[next.segment] >= 0) { // a ring
                    if (start == 1) rings_[first] = here;
                    break;
                }
                const double l = distance(blade[next.segment].from, blade[next.segment].to);
                place(next.segment, first, next.end == end ? -along_[at] : along_[at], start == 1 ? here : here - l);
                at = next.segment;
                end = 1 - next.end;
            }
    }
}

/// [m] Four times the area of a ring over its length: the diameter of a circle, twice the width of a strip.
double BladeRuns::widthOf(int ring, std::span<const BladeSegment> blade) const
{
    const Vec3 middle = blade[ring].from;
    Vec3 area;
    for (std::size_t i = 0; i < blade.size(); ++i)
        if (chains_[i] == ring) area += 0.5 * along_[i] * cross(blade[i].from - middle, blade[i].to - middle);
    return 4.0 * length(area) / rings_[ring];
}

/// Each segment of a chain is a blade of its own from now on.
void BladeRuns::separate(int chain)
{
    rings_[chain] = 0.0;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        if (chains_[i] != chain) continue;
        joints_[i] = {};
        along_[i] = 1.0;
        chains_[i] = static_cast<int>(i);
    }
}

SweptPlace BladeRuns::placeAt(int segment, double u, double t) const
{
    if (joints_[segment][0].segment < 0 && joints_[segment][1].segment < 0) return {};
    const Stretch& s = stretches_[segment];
    return {pass_, segment, std::lerp(s.from, s.to, u), std::lerp(s.before, s.now, t)};
}

double BladeRuns::distanceBetween(const SweptPlace& a, const SweptPlace& b) const
{
    if (a.pass != pass_ || b.pass != pass_ || chains_[a.segment] != chains_[b.segment])
        return std::numeric_limits<double>::infinity();
    const double along = std::abs(a.along - b.along), ring = rings_[chains_[a.segment]];
    return std::hypot(ring > 0.0 ? std::min(along, ring - along) : along, a.way - b.way);
}

void BladeRuns::setSideAt(const SweptPlace& place, int side)
{
    if (place.pass != pass_) return;
    for (std::size_t i = 0; i < runs_.size(); ++i)
        if (runs_[i] == runs_[place.segment] && sides_[i] == 0) sides_[i] = side;
}

void BladeRuns::follow(std::span<const BladeSegment> blade, Vec3 tissue, double memory)
{
    std::vector<Vec3> ways(blade.size());
    std::vector<double> onwards(blade.size()); // per chain
    for (std::size_t i = 0; i < blade.size(); ++i) {
        const BladeSegment& s = blade[i];
        const Vec3 way = 0.5 * (s.from - s.fromBefore + s.to - s.toBefore) - tissue, along = normalized(s.to - s.from);
        ways[i] = way - dot(way, along) * along;
        onwards[static_cast<std::size_t>(chains_[i])] += dot(ways[i], directions_[i]);
    }
    for (std::size_t i = 0; i < blade.size(); ++i) {
        // A blade that saws moves both ways in one surface.
        const bool back = onwards[static_cast<std::size_t>(chains_[i])] < 0.0;
        if (back) ways[i] = -ways[i];
        stretches_[i].before = stretches_[i].now;
        stretches_[i].now += (back ? -1.0 : 1.0) * length(ways[i]);
        directions_[i] = std::exp(-length(ways[i]) / memory) * directions_[i] + ways[i];
    }
    findRuns(blade);
}

void BladeRuns::findRuns(std::span<const BladeSegment> blade)
{
    double longest = 0.0;
    for (Vec3 direction : directions_) longest = std::max(longest, length(direction));
    const auto count = static_cast<int>(blade.size());
    std::vector<Vec3> normals(blade.size());
    for (int i = 0; i < count; ++i)
        if (length(directions_[i]) > kSliding * longest)
            normals[i] = along_[i] * normalized(cross(blade[i].to - blade[i].from, directions_[i]));
    runs_.assign(blade.size(), -1);
    for (int first = 0; first < count; ++first) {
        if (runs_[first] >= 0) continue;
        runs_[first] = first;
        for (int start : {1, 0})
            for (int at = first, end = start;;) {
                const Joint next = joints_[at][end];
                if (next.segment < 0 || runs_[next.segment] >= 0 || normals[at] == Vec3{} ||
                    normals[next.segment] == Vec3{} || dot(normals[at], normals[next.segment]) < kSharpest)
                    break;
                runs_[next.segment] = first;
                at = next.segment;
                end = 1 - next.end;
            }
    }
}

} // namespace filasofia::engine
