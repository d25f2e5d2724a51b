#include "filasofia/engine/topology/cut_rods.h"

#include "filasofia/core/hash.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/rupture/blade.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/topology/split_channels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::Rupture;

geometry::Box boxOf(const MovingEdge& edge)
{
    return geometry::boxAround(std::vector{edge.a, edge.b, edge.aBefore, edge.bBefore});
}

/// Appends where a blade has crossed edges.
void findCrossings(const Blade& blade, const Rod& rod, std::span<const Vec3> before, std::span<const Vec3> now,
                   std::vector<RodCut>& cuts)
{
    for (std::size_t e = 0; e < rod.edges.size(); ++e) {
        if (isCut(rod, e)) continue;
        const auto next = static_cast<std::size_t>(rod.edges[e].nodes[1]);
        const MovingEdge edge{now[e], now[next], before[e], before[next]};
        const geometry::Box box = boxOf(edge);
        if (!overlap(box, blade.swept)) continue;
        for (const auto& [one, two] : blade.lines) {
            const auto from = static_cast<std::size_t>(one), to = static_cast<std::size_t>(two);
            const BladeSegment segment{blade.now[from], blade.now[to], blade.before[from], blade.before[to]};
            const double motion =
                std::max({distance(segment.from, segment.fromBefore), distance(segment.to, segment.toBefore),
                          distance(edge.a, edge.aBefore), distance(edge.b, edge.bBefore)});
            const double parts = std::ceil(2.0 * motion / rod.edges[e].restLength);
            constexpr double kMostParts = 1000.0;
            const auto s = crossingOf(edge, segment, static_cast<int>(std::clamp(parts, 1.0, kMostParts)));
            if (!s) continue;
            cuts.push_back({static_cast<int>(e), *s});
            break;
        }
    }
}

/// Each edge once, and none at an end that is free already: a blade that crosses a rod at a node crosses both edges
/// there, perhaps one of them in the next step, and one of them is enough.
void dropTwins(const Rod& rod, std::vector<RodCut>& cuts)
{
    constexpr double kAtNode = 1e-6;
    std::ranges::stable_sort(cuts, {}, &RodCut::edge);
    const auto sameEdge = [](const RodCut& a, const RodCut& b) { return a.edge == b.edge; };
    cuts.erase(std::unique(cuts.begin(), cuts.end(), sameEdge), cuts.end());
    std::vector<RodCut> kept;
    const std::size_t edges = rod.edges.size();
    const auto isGone = [&](std::size_t edge) {
        return isCut(rod, edge) || std::ranges::find(kept, static_cast<int>(edge), &RodCut::edge) != kept.end();
    };
    for (const RodCut& each : cuts) {
        const auto e = static_cast<std::size_t>(each.edge);
        const bool first = !isRing(rod) && e == 0, last = !isRing(rod) && e + 1 == edges;
        const bool atFirst = each.s < kAtNode && (first || isGone(wrapped(e + edges - 1, edges)));
        const bool atLast = each.s > 1.0 - kAtNode && (last || isGone(wrapped(e + 1, edges)));
        if (!atFirst && !atLast) kept.push_back(each);
    }
    cuts = std::move(kept);
}

/// A point on an edge that is cut goes on at its place, as a point beyond the end of the next edge of its side.
void follow(const Rod& rod, const RodCut& cut, std::vector<NodeWeight>& point)
{
    const auto e = static_cast<std::size_t>(cut.edge);
    const auto [first, second] = rod.edges[e].nodes;
    if (point.size() != 2) return;
    const bool forwards = point[0].node == first && point[1].node == second;
    if (!forwards && !(point[0].node == second && point[1].node == first)) return;
    const double t = forwards ? point[1].weight : point[0].weight;
    const bool before = t < cut.s;
    const int node = before ? first : second;
    const std::size_t edges = rod.edges.size(), inner = wrapped(before ? e + edges - 1 : e + 1, edges);
    const bool atEnd = !isRing(rod) && (before ? e == 0 : e + 1 == edges);
    if (atEnd || isCut(rod, inner)) {
        point = {{node, 1.0}};
        return;
    }
    const double beyond = (before ? t : 1.0 - t) * rod.edges[e].restLength / rod.edges[inner].restLength;
    const int other = before ? rod.edges[inner].nodes[0] : rod.edges[inner].nodes[1];
    point = {{other, -beyond}, {node, 1.0 + beyond}};
}

/// Per node the lowest node that is connected with it.
std::vector<int> connected(const Rod& rod, std::size_t nodes)
{
    std::vector<int> label(nodes);
    for (std::size_t i = 0; i < nodes; ++i) label[i] = i > 0 && !isCut(rod, i - 1) ? label[i - 1] : static_cast<int>(i);
    if (isRing(rod) && !isCut(rod, nodes - 1)) std::ranges::replace(label, int{label[nodes - 1]}, 0);
    return label;
}

/// Updates the pieces of a rod after cuts. A piece that falls apart leaves its number to the part that has its first
/// node. Returns the new ones.
std::vector<physics::LoosePiece> findRodPieces(SoftModel& model)
{
    std::vector<BodyPiece> before = std::move(model.pieces);
    if (before.empty()) {
        before.push_back({.number = 0, .nodes = {}, .elements = {}});
        for (int i = 0; i < static_cast<int>(model.rest.size()); ++i) before[0].nodes.push_back(i);
    }
    const std::vector<int> label = connected(model.rod, model.rest.size());
    std::vector<physics::LoosePiece> loose;
    std::vector<BodyPiece> now;
    for (const BodyPiece& piece : before) {
        std::map<int, std::size_t> parts; // by label
        for (int node : piece.nodes) {
            const auto [part, made] = parts.emplace(label[static_cast<std::size_t>(node)], now.size());
            if (made) {
                const int number = parts.size() == 1 ? piece.number : model.rod.pieces++;
                now.push_back({.number = number, .nodes = {}, .elements = {}});
                if (parts.size() > 1) loose.push_back({.piece = number});
            }
            now[part->second].nodes.push_back(node);
        }
    }
    std::ranges::sort(now, {}, &BodyPiece::number);
    if (now.size() < 2 && model.removed.empty()) now.clear();
    findHeld(model.pins, now);
    model.pieces = std::move(now);
    for (physics::LoosePiece& each : loose)
        for (int node : std::ranges::find(model.pieces, each.piece, &BodyPiece::number)->nodes)
            if (const auto e = static_cast<std::size_t>(node); e < model.rod.edges.size() && !isCut(model.rod, e))
                each.elements.push_back(node);
    return loose;
}

std::uint64_t rodHistoryWith(const RodCut& cut, std::uint64_t before)
{
    Hasher hash;
    hash.add(before);
    hash.add(static_cast<std::uint64_t>(cut.edge));
    return hash.value();
}

void applyCuts(Rupture::Kind kind, std::vector<RodCut>& cuts, SoftBody& body, Scene& scene,
               physics::TopologyReport& report)
{
    SoftModel& model = body.model;
    Rod& rod = model.rod;
    BodyTopology& topology = body.topology;
    std::erase_if(cuts, [&](const RodCut& each) { return isCut(rod, static_cast<std::size_t>(each.edge)); });
    if (cuts.empty()) return;
    if (!std::exchange(topology.edited, true)) topology.startAttachments = scene.attachments;
    Rupture rupture{.kind = kind, .body = model.id};
    rod.cut.resize(rod.edges.size());
    for (const RodCut& cut : cuts) {
        const auto e = static_cast<std::size_t>(cut.edge);
        rod.cut[e] = true;
        body.state.rod.tensions[e] = 0.0;
        const Vec3 a = body.state.x[e], b = body.state.x[static_cast<std::size_t>(rod.edges[e].nodes[1])];
        rupture.place += 1.0 / static_cast<double>(cuts.size()) * (a + cut.s * (b - a));
        rupture.area += std::numbers::pi * rod.radius * rod.radius;
        ++topology.revision;
        topology.history = rodHistoryWith(cut, topology.history);
        for (Attachment& each : scene.attachments)
            for (auto& pair : each.pairs) {
                if (each.body == model.id) follow(rod, cut, pair[0].nodes);
                if (each.to == model.id) follow(rod, cut, pair[1].nodes);
            }
        splitChannels(body, cut.edge, cut.s, scene);
    }
    cuts.clear();
    rupture.detached = findRodPieces(model);
    measure(model, body.state, rupture.detached);
    tellForces(rupture.detached, body, scene);
    cutRodCollision(model, scene);
    outdate(true, body.system);
    report.ruptures.push_back(std::move(rupture));
}

} // namespace

void findRodCuts(const std::vector<Blade>& blades, SoftBody& body, physics::TopologyReport& report)
{
    const SoftModel& model = body.model;
    BodyTopology& topology = body.topology;
    const std::vector<Vec3>& now = body.state.x;
    const auto cuts = [&](const Blade& blade) { return mayBeCut(model, blade.shape->group); };
    const bool followed = std::exchange(topology.followed, std::ranges::any_of(blades, cuts));
    if (!topology.followed) return;
    if (!followed) topology.places = now; // where it was before is unknown
    const geometry::Box box = merged(geometry::boxAround(topology.places), geometry::boxAround(now));
    for (const Blade& blade : blades) {
        if (!cuts(blade) || !overlap(blade.swept, box)) continue;
        if (blade.jumped) ++report.bladeTooFast;
        findCrossings(blade, model.rod, topology.places, now, topology.cutEdges);
    }
    dropTwins(model.rod, topology.cutEdges);
    topology.places = now;
}

void findRodTears(SoftBody& body)
{
    const SoftModel& model = body.model;
    const Rod& rod = model.rod;
    if (!(rod.breakForce < std::numeric_limits<double>::infinity())) return;
    const std::vector<int> label = connected(rod, model.rest.size());
    std::map<int, int> worst; // per piece
    for (std::size_t e = 0; e < rod.edges.size(); ++e) {
        if (isCut(rod, e) || clamped(model.pins.hard, e)) continue;
        const std::vector<double>& tensions = body.state.rod.tensions;
        if (!(tensions[e] > rod.breakForce)) continue;
        const auto [place, made] = worst.emplace(label[e], static_cast<int>(e));
        if (!made && tensions[e] > tensions[static_cast<std::size_t>(place->second)])
            place->second = static_cast<int>(e);
    }
    for (const auto& [piece, edge] : worst) body.topology.tornEdges.push_back({edge});
}

void applyRodCuts(SoftBody& body, Scene& scene, physics::TopologyReport& report)
{
    applyCuts(Rupture::Kind::Cut, body.topology.cutEdges, body, scene, report);
    applyCuts(Rupture::Kind::Tear, body.topology.tornEdges, body, scene, report);
}

void cutRodCollision(SoftModel& model, Scene& scene)
{
    if (model.collision.empty()) return;
    std::vector<std::array<int, 2>> segments;
    std::vector<bool> left(model.rest.size());
    for (std::size_t e = 0; e < model.rod.edges.size(); ++e) {
        if (isCut(model.rod, e)) continue;
        auto ends = model.rod.edges[e].nodes;
        for (int node : ends) left[static_cast<std::size_t>(node)] = true;
        segments.push_back({std::min(ends[0], ends[1]), std::max(ends[0], ends[1])});
    }
    std::vector<int> lone;
    for (const BodyPiece& piece : model.pieces)
        for (int node : piece.nodes)
            if (!left[static_cast<std::size_t>(node)]) lone.push_back(node);
    std::ranges::sort(lone);
    forgetSurface({model.id, 0}, scene);
    model.collision[0] = cutCollision(model.collision[0], std::move(segments), std::move(lone));
}

} // namespace filasofia::engine
