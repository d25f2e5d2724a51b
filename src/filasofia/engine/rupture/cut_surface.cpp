#include "filasofia/engine/rupture/cut_surface.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::engine {
namespace {

using geometry::Tetrahedron;

/// Tolerances in place and direction for things on one sheet. Places are fractions of an edge's length.
constexpr double kSamePlace = 0.3, kSameDirection = 0.5; ///< a crossing at a node that is on the sheet already
constexpr double kAlignPlace = 0.4;                      ///< a new label and its neighbour's plane
constexpr double kMemberDirection = 0.3, kMemberPlace = 0.5, kMemberMargin = 0.1; ///< a node in an element's sheet
/// The same for two nodes that the blade passed one after the other, or at once, around a bend.
constexpr double kBendDirection = -0.5, kBendPlace = 2.0, kBendMargin = 0.5;
constexpr double kFlat = 0.05; ///< slope to each other of places that count as one plane

class SheetCut {
public:
    SheetCut(EditableMesh& mesh, int sheet, const CutParameters& parameters, BladeRuns& blade, RuptureReport& report)
        : mesh_(mesh), data_(mesh.data()), sheet_(sheet), parameters_(parameters), blade_(blade), report_(report)
    {
    }

    void cut(std::vector<Crossing>& crossings)
    {
        // Long edges first: bisecting them leaves the best elements. Ties are broken by node, so the order is the same
        // on every machine.
        std::ranges::sort(crossings, [](const Crossing& x, const Crossing& y) {
            if (x.length != y.length) return x.length > y.length;
            return std::pair(x.a, x.b) < std::pair(y.a, y.b);
        });
        snap(crossings);
        bisect(crossings);
        std::vector<int> candidates = flagFaces();
        keepFlakes(candidates);
        openFaces(mesh_, openingLimits(parameters_, mesh_.meanEdge()), std::move(candidates), report_);
    }

private:
    [[nodiscard]] bool hasLabel(int node) const { return data_.labels[node].sheet == sheet_; }

    /// [m] How far a place on the sheet is from a label's plane. Around a corner of the blade, it is enough if the
    /// label is near the other's plane.
    [[nodiscard]] static double planeDistance(const CutLabel& label, const CutLabel& other)
    {
        const Vec3 way = other.point - label.point;
        const double away = std::abs(dot(label.normal, way));
        return label.swept.pass > 0 && other.swept.pass > 0 ? std::min(away, std::abs(dot(other.normal, way))) : away;
    }

    [[nodiscard]] CutLabel labelOf(const Crossing& c) const { return {sheet_, 0, c.point, c.normal, c.facet, c.swept}; }

    [[nodiscard]] bool onSheet(int node, const Crossing& c) const
    {
        const CutLabel& label = data_.labels[node];
        return hasLabel(node) && planeDistance(label, labelOf(c)) <= kSamePlace * c.length &&
               std::abs(dot(label.normal, c.normal)) > kSameDirection;
    }

    [[nodiscard]] bool alive(const Crossing& c)
    {
        edgeStar(data_, c.a, c.b, star_);
        return !star_.empty() && !mesh_.isGone(c.a);
    }

    void label(int node, Vec3 point, const Crossing& crossing)
    {
        CutLabel mine = labelOf(crossing);
        mine.point = point;
        // The newest neighbour on the same sheet decides the normal's orientation.
        int guide = -1;
        for (int t : data_.around[node])
            for (int n : nodesOf(data_.tetrahedra[t])) {
                const CutLabel& l = data_.labels[n];
                if (n == node || !hasLabel(n) || std::abs(dot(l.normal, mine.normal)) <= kSameDirection ||
                    (guide >= 0 && l.sequence <= data_.labels[guide].sequence) ||
                    planeDistance(mine, l) > kAlignPlace * distance(data_.rest[n], data_.rest[node]))
                    continue;
                guide = n;
            }
        // If there is none yet, the side of the segment decides, so that a ring is cut with one side inwards all
        // around. A segment that has none follows the sheet's newest label: the two jaws of scissors come from two
        // sides.
        const int known = blade_.sideAt(crossing.swept);
        const Vec3 up = guide >= 0   ? data_.labels[guide].normal
                        : known != 0 ? static_cast<double>(known) * mine.normal
                                     : mesh_.sheetNormal(sheet_);
        const bool opposite = dot(up, mine.normal) < 0.0;
        if (known == 0) blade_.setSideAt(crossing.swept, opposite ? -1 : 1);
        if (opposite) {
            mine.normal = -mine.normal;
            mine.facet = -mine.facet;
        }
        mesh_.setSheetNormal(sheet_, mine.normal);
        mine.sequence = mesh_.nextSequence();
        mesh_.setLabel(node, mine);
        fresh_.push_back(node);
    }

    void snap(std::vector<Crossing>& crossings)
    {
        std::vector<std::pair<double, int>> order;
        for (int i = 0; i < static_cast<int>(crossings.size()); ++i)
            if (const double e = std::min(crossings[i].s, 1.0 - crossings[i].s); e < parameters_.snap)
                order.emplace_back(e, i);
        std::ranges::sort(order); // the closest first
        for (auto [e, i] : order) {
            const Crossing& c = crossings[i];
            if (onSheet(c.a, c) || onSheet(c.b, c)) continue;
            if (!alive(c)) {
                ++report_.refused[static_cast<int>(RuptureRefusal::EdgeGone)];
                continue;
            }
            const bool first = c.s < 0.5;
            const int node = first ? c.a : c.b, toward = first ? c.b : c.a;
            label(node, c.point, c);
            ++report_.snapped;
            if (parameters_.moveNodes && e > 1e-9 && slide(node, toward, e)) relabel(node);
        }
        std::erase_if(crossings, [&](const Crossing& c) { return std::min(c.s, 1.0 - c.s) < parameters_.snap; });
    }

    void relabel(int node)
    {
        CutLabel l = data_.labels[node];
        l.point = data_.rest[node];
        mesh_.setLabel(node, l);
    }

    /// Slides the node as far as its elements allow. Returns true if it reached the surface.
    bool slide(int node, int toward, double s)
    {
        const bool boundary = onBoundary(data_, node);
        if (boundary && !onBoundary(data_, node, toward)) return false;
        double before = 1.0, volume = 0.0;
        for (int t : data_.around[node]) {
            before = std::min(before, restQuality(data_, t));
            volume += restVolume(data_, t);
        }
        const double least = std::min(before, std::max(parameters_.minQuality, 0.5 * before));
        for (double share : {1.0, 0.5, 0.25}) {
            const double way = share * s;
            const double after = volumeAfter(node, toward, way, least);
            if (std::isnan(after)) continue;
            const double change = std::abs(after - volume), whole = mesh_.startVolume();
            if ((boundary || mesh_.isSheet()) && (change > parameters_.slideVolume * whole ||
                                                  change + mesh_.volumeMoved() > parameters_.slideVolumes * whole))
                continue;
            if (boundary || mesh_.isSheet()) mesh_.addVolumeMoved(change);
            mesh_.slide(node, toward, way);
            ++report_.moves;
            return share == 1.0;
        }
        return false;
    }

    /// [m^3] volume of the elements around the node after the slide; NaN if one of them would become too bad.
    [[nodiscard]] double volumeAfter(int node, int toward, double s, double least) const
    {
        const Vec3 rest = (1.0 - s) * data_.rest[node] + s * data_.rest[toward];
        const Vec3 current = (1.0 - s) * data_.current[node] + s * data_.current[toward];
        double sum = 0.0;
        for (int t : data_.around[node]) {
            const Tetrahedron& n = data_.tetrahedra[t];
            const int at = placeOf(n, node);
            const MovedElement p = afterMove(mesh_.isSheet(), solidCorners(n, data_.rest), at, rest);
            const MovedElement x = afterMove(mesh_.isSheet(), solidCorners(n, data_.current), at, current);
            if (p.quality < least || x.volume < parameters_.minVolumeRatio * p.volume) return std::nan("");
            sum += p.volume;
        }
        return sum;
    }

    void bisect(std::vector<Crossing>& crossings)
    {
        const int maxTetrahedra = mesh_.tetrahedra() + parameters_.maxNewTetrahedra;
        const double shortest = parameters_.shortestEdge * mesh_.meanEdge();
        std::size_t done = 0;
        for (; done < crossings.size() && mesh_.tetrahedra() < maxTetrahedra; ++done) {
            const Crossing& c = crossings[done];
            if (onSheet(c.a, c) || onSheet(c.b, c)) continue;
            if (!alive(c)) {
                ++report_.refused[static_cast<int>(RuptureRefusal::EdgeGone)];
                continue;
            }
            const bool longEnough = distance(data_.rest[c.a], data_.rest[c.b]) >= shortest;
            const auto goodEnough = [&](double s) {
                return mesh_.qualityAfterBisecting(c.a, c.b, s, star_) >= parameters_.minQuality;
            };
            const double inwards = 0.5 * (c.s + 0.5);
            if (longEnough && (goodEnough(c.s) || goodEnough(inwards))) {
                const int node = mesh_.bisect(c.a, c.b, goodEnough(c.s) ? c.s : inwards);
                label(node, data_.rest[node], c);
                ++report_.bisections;
            } else {
                label(c.s < 0.5 ? c.a : c.b, c.point, c);
                ++report_.snappedGuard;
            }
        }
        crossings.erase(crossings.begin(), crossings.begin() + static_cast<std::ptrdiff_t>(done));
    }

    /// Mask of the corners that lie on the sheet of the newest of them. Its plane excludes other parts of a curled
    /// sheet.
    [[nodiscard]] unsigned members(int t) const
    {
        const std::span<const int> n = nodesOf(data_.tetrahedra[t]);
        int newest = -1;
        for (int k : n)
            if (hasLabel(k) && (newest < 0 || data_.labels[k].sequence > data_.labels[newest].sequence)) newest = k;
        if (newest < 0) return 0;
        const CutLabel& guide = data_.labels[newest];
        unsigned mask = 0;
        for (std::size_t i = 0; i < n.size(); ++i) {
            const CutLabel& l = data_.labels[n[i]];
            if (!hasLabel(n[i])) continue;
            const double way = distance(data_.rest[n[i]], data_.rest[newest]), direction = dot(l.normal, guide.normal);
            if (n[i] == newest ||
                (direction > kMemberDirection &&
                 planeDistance(guide, l) <= kMemberPlace * way + kMemberMargin * mesh_.meanEdge()) ||
                (direction > kBendDirection &&
                 blade_.distanceBetween(l.swept, guide.swept) <= kBendPlace * way + kBendMargin * mesh_.meanEdge()))
                mask |= 1u << i;
        }
        return mask;
    }

    /// [m] How far a place is above the sheet at the labels of an element's corners: in the mean. If a blade bends away
    /// from its normals there, above is what is above any of the labels' planes; if towards them, what is above all.
    [[nodiscard]] double heightAbove(std::span<const int> nodes, unsigned mask, Vec3 place) const
    {
        bool bends = true;
        double bend = 0.0, span = 0.0, sum = 0.0;
        double highest = -std::numeric_limits<double>::infinity(), lowest = -highest;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if ((mask >> i & 1u) == 0) continue;
            const CutLabel& label = data_.labels[nodes[i]];
            const double height = dot(label.facet, place - label.point);
            bends = bends && label.swept.pass > 0;
            sum += height;
            highest = std::max(highest, height);
            lowest = std::min(lowest, height);
            for (std::size_t j = 0; j < nodes.size(); ++j) {
                if (j == i || (mask >> j & 1u) == 0) continue;
                const Vec3 way = data_.labels[nodes[j]].point - label.point;
                bend += dot(label.facet, way);
                span += length(way);
            }
        }
        if (!bends || std::abs(bend) <= kFlat * span) return sum / std::popcount(mask);
        return bend < 0.0 ? highest : lowest;
    }

    /// +1 above the sheet, -1 below, 0 if the element does not lie along it. The side is decided once and then kept.
    int sideOf(int t, unsigned mask)
    {
        const std::span<const int> n = nodesOf(data_.tetrahedra[t]);
        const int count = std::popcount(mask), corners = static_cast<int>(n.size());
        if (count < corners - 1) return 0;
        if (data_.sides[t] / 2 == sheet_) return (data_.sides[t] & 1) != 0 ? 1 : -1;
        double h = 0.0;
        for (int i = 0; i < corners; ++i)
            if ((mask >> i & 1u) == 0) h = heightAbove(n, mask, data_.rest[n[i]]);
        const double size =
            mesh_.isSheet() ? std::sqrt(2.0 * restVolume(data_, t)) : std::cbrt(6.0 * restVolume(data_, t));
        if (std::abs(h) < 1e-7 * size) h = heightAbove(n, mask, middleOf(data_.tetrahedra[t], data_.rest));
        mesh_.setSide(t, 2 * sheet_ + (h >= 0.0 ? 1 : 0));
        return h >= 0.0 ? 1 : -1;
    }

    /// Flags faces at the labels of this step. Returns the candidates for opening: all nodes of flagged faces there.
    std::vector<int> flagFaces()
    {
        std::vector<int> candidates, near;
        for (int node : fresh_) near.insert(near.end(), data_.around[node].begin(), data_.around[node].end());
        sortUnique(near);
        for (int t : near) {
            const unsigned mask = members(t);
            const int side = sideOf(t, mask);
            for (int f = 0; f < 4 && side != 0; ++f) {
                const int other = data_.neighbours[t][f];
                const unsigned face = (mesh_.isSheet() ? 0x7u : 0xfu) & ~(1u << static_cast<unsigned>(f));
                if (other < 0 || (data_.flagged[t] >> f & 1) != 0 || (mask & face) != face) continue;
                const unsigned otherMask = members(other);
                const int otherSide = sideOf(other, otherMask);
                if (otherSide == 0 || otherSide == side) continue;
                bool both = true;
                forEachFaceNode(data_.tetrahedra[t], f, [&](int k) {
                    both = both && (otherMask >> placeOf(data_.tetrahedra[other], k) & 1u) != 0;
                });
                if (!both) continue;
                mesh_.setFlagged(t, f, true);
                ++report_.flagged;
                forEachFaceNode(data_.tetrahedra[t], f, [&](int k) { candidates.push_back(k); });
            }
        }
        for (int node : fresh_)
            for (int t : data_.around[node])
                if ((data_.flagged[t] & ~(1 << placeOf(data_.tetrahedra[t], node))) != 0) {
                    candidates.push_back(node);
                    break;
                }
        return candidates;
    }

    /// An element that the cut would detach on its own changes to the other side instead.
    void keepFlakes(const std::vector<int>& candidates)
    {
        if (candidates.empty()) return;
        if (mesh_.isSheet()) return keepSlivers();
        for (int node : fresh_)
            for (int t : data_.around[node]) {
                if (data_.flagged[t] == 0) continue;
                unsigned inside = 0;
                for (int f = 0; f < 4; ++f)
                    if (data_.neighbours[t][f] >= 0) inside |= 1u << static_cast<unsigned>(f);
                if (data_.flagged[t] != inside) continue;
                for (int f = 0; f < 4; ++f) mesh_.setFlagged(t, f, false);
                mesh_.setSide(t, data_.sides[t] ^ 1);
                ++report_.flakes;
            }
    }

    /// In a sheet, triangles all of whose nodes are on the cut are no tissue beside it: if the cut would detach some of
    /// them, they change to the other side.
    void keepSlivers()
    {
        constexpr std::size_t kMost = 16;
        std::vector<int> piece;
        const auto onCut = [&](int t) {
            return std::ranges::all_of(nodesOf(data_.tetrahedra[t]), [&](int n) { return hasLabel(n); });
        };
        const auto isSliver = [&](int first) { // and leaves its triangles in `piece`
            piece = {first};
            for (std::size_t i = 0; i < piece.size(); ++i) {
                const int t = piece[i];
                if (!onCut(t) || piece.size() > kMost) return false;
                for (int f = 0; f < 3; ++f)
                    if (const int other = data_.neighbours[t][f]; other >= 0 && (data_.flagged[t] >> f & 1) == 0 &&
                                                                  std::ranges::find(piece, other) == piece.end())
                        piece.push_back(other);
            }
            return true;
        };
        for (int node : fresh_)
            for (int t : data_.around[node]) {
                if (data_.flagged[t] == 0 || !isSliver(t)) continue;
                ++report_.flakes;
                for (int each : piece) {
                    for (int f = 0; f < 3; ++f) mesh_.setFlagged(each, f, false);
                    mesh_.setSide(each, data_.sides[each] ^ 1);
                }
            }
    }

    EditableMesh& mesh_;
    const MeshTopology& data_;
    int sheet_;
    const CutParameters& parameters_;
    BladeRuns& blade_;
    RuptureReport& report_;
    std::vector<int> fresh_; ///< nodes labelled in this step, in order
    std::vector<int> star_;
};

} // namespace

CutParameters sheetParameters()
{
    return {.snap = 0.2, .minQuality = 0.25, .slideVolume = 1e-12, .slideVolumes = 1e-9};
}

OpeningLimits openingLimits(const CutParameters& parameters, double meanEdge)
{
    return {.minQuality = parameters.minQuality, .shortestEdge = parameters.shortestEdge * meanEdge};
}

void cutCrossings(EditableMesh& mesh, int sheet, const CutParameters& parameters, BladeRuns& blade,
                  std::vector<Crossing>& crossings, RuptureReport& report)
{
    if (crossings.empty()) return;
    SheetCut(mesh, sheet, parameters, blade, report).cut(crossings);
}

} // namespace filasofia::engine
