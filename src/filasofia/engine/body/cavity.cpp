#include "filasofia/engine/body/cavity.h"

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/core/error.h"
#include "filasofia/engine/body/body_topology.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/geometry/solid_angle.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace filasofia::engine {
namespace {

// [-] As a share of the volume at the start. A cavity that is squeezed flatter, or inside out, keeps the pressure that
// it has there.
constexpr double kSmallestVolume = 1e-3;
// [-] The same: below this, suction fades. Else the walls would be drawn through each other.
constexpr double kFading = 0.1;

/// [m^3] Six times the volume of a tetrahedron with a corner at the origin.
double tripleProduct(Vec3 a, Vec3 b, Vec3 c) { return dot(a, cross(b, c)); }

/// Per edge of every triangle: the triangle across it, or -1; three per triangle, from its corner on.
std::vector<std::array<int, 3>> trianglesBeside(const std::vector<geometry::Triangle>& triangles)
{
    struct Entry {
        int low, high, triangle, edge;
    };
    std::vector<Entry> entries;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t e = 0; e < 3; ++e) {
            const auto [low, high] = std::minmax(triangles[t][e], triangles[t][(e + 1) % 3]);
            entries.push_back({low, high, static_cast<int>(t), static_cast<int>(e)});
        }
    std::ranges::sort(entries, {}, [](const Entry& e) { return std::array{e.low, e.high, e.triangle, e.edge}; });
    std::vector<std::array<int, 3>> out(triangles.size(), {-1, -1, -1});
    for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
        const Entry &a = entries[i], &b = entries[i + 1];
        if (a.low != b.low || a.high != b.high) continue;
        out[static_cast<std::size_t>(a.triangle)][static_cast<std::size_t>(a.edge)] = b.triangle;
        out[static_cast<std::size_t>(b.triangle)][static_cast<std::size_t>(b.edge)] = a.triangle;
    }
    return out;
}

/// Per triangle: the first triangle of the part of the surface that it belongs to.
std::vector<int> partsOf(const std::vector<std::array<int, 3>>& neighbours)
{
    DisjointSets parts(neighbours.size());
    for (std::size_t t = 0; t < neighbours.size(); ++t)
        for (int other : neighbours[t])
            if (other >= 0) parts.join(static_cast<int>(t), other);
    std::vector<int> out(neighbours.size());
    for (std::size_t t = 0; t < out.size(); ++t) out[t] = parts.find(static_cast<int>(t));
    return out;
}

/// The triangle as seen from the tissue: that of a solid is seen from its cavity, that of a shell from outside.
geometry::Triangle fromTissue(const geometry::Triangle& t, const SoftModel& model)
{
    return isShell(model) ? t : geometry::Triangle{t[0], t[2], t[1]};
}

/// A part of the surface with the space that it encloses.
struct Space {
    int part = 0;
    double volume = 0.0; ///< [m^3]
};

/// The closed inner parts of a body's surface, or a whole shell without a rim, the largest first.
std::vector<Space> spacesOf(const SoftModel& model, const std::vector<std::array<int, 3>>& neighbours,
                            const std::vector<int>& parts)
{
    std::map<int, std::pair<double, bool>> found; // volume, and whether it has a rim
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const geometry::Triangle n = fromTissue(model.surface[t], model);
        auto& [volume, rim] = found[parts[t]];
        const auto at = [&](int node) { return model.rest[static_cast<std::size_t>(node)] - model.rest.front(); };
        volume += tripleProduct(at(n[0]), at(n[1]), at(n[2])) / 6.0;
        rim = rim || std::ranges::any_of(neighbours[t], [](int other) { return other < 0; });
    }
    std::vector<Space> out;
    for (const auto& [part, space] : found)
        if (space.first > 0.0 && !space.second) out.push_back({part, space.first});
    std::ranges::stable_sort(out, std::ranges::greater{}, &Space::volume);
    return out;
}

/// Whether a closed part of the surface goes around a point.
bool goesAround(const SoftModel& model, const std::vector<int>& parts, int part, Vec3 point)
{
    double solid = 0.0;
    for (std::size_t t = 0; t < parts.size(); ++t) {
        if (parts[t] != part) continue;
        const auto corner = [&](std::size_t k) { return model.rest[static_cast<std::size_t>(model.surface[t][k])]; };
        solid += geometry::solidAngle(point, corner(0), corner(1), corner(2));
    }
    return std::abs(solid) > 2.0 * std::numbers::pi;
}

/// Joins directed edges to rims by the nodes that they share.
std::vector<CavityRim> rimsOf(const std::vector<std::array<int, 2>>& edges)
{
    DisjointSets parts(edges.size());
    std::map<int, int> firstAt;
    for (std::size_t e = 0; e < edges.size(); ++e)
        for (int node : edges[e]) {
            const auto [place, isNew] = firstAt.emplace(node, static_cast<int>(e));
            if (!isNew) parts.join(static_cast<int>(e), place->second);
        }
    std::map<int, CavityRim> rims;
    for (std::size_t e = 0; e < edges.size(); ++e) rims[parts.find(static_cast<int>(e))].edges.push_back(edges[e]);
    std::vector<CavityRim> out;
    for (auto& [first, rim] : rims) out.push_back(std::move(rim));
    return out;
}

/// What a part of the surface consists of now.
struct Mixture {
    bool outside = false;      ///< triangles that were outside at the start
    std::optional<int> cavity; ///< the first of the cavities whose wall it has
    bool several = false;      ///< it has walls of other cavities as well, or edges without a neighbour
};

/// A liquid moves with its wall: its mass at the start is divided over the wall by areas. Its weight is not there, but
/// in its pressure.
void addInertia(const Cavity& cavity, SoftModel& model)
{
    if (cavity.def.fill != physics::CavityFill::Liquid) return;
    double whole = 0.0;
    for (const geometry::Triangle& t : cavity.wall) whole += length(areaOf(t, model.rest));
    const double perArea = densityOf(cavity) * cavity.restVolume / whole;
    model.filling.resize(model.rest.size());
    for (const geometry::Triangle& t : cavity.wall) {
        const double share = perArea * length(areaOf(t, model.rest)) / 3.0;
        for (int node : t) {
            model.masses[static_cast<std::size_t>(node)] += share;
            model.filling[static_cast<std::size_t>(node)] += share;
        }
    }
}

} // namespace

Vec3 areaOf(const geometry::Triangle& t, std::span<const Vec3> x)
{
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    return 0.5 * cross(at(1) - at(0), at(2) - at(0));
}

Vec3 middleOf(const CavityRim& rim, std::span<const Vec3> x)
{
    Vec3 sum;
    for (const auto& [a, b] : rim.edges) sum += x[static_cast<std::size_t>(a)];
    return 1.0 / static_cast<double>(rim.edges.size()) * sum;
}

double densityOf(const Cavity& cavity)
{
    return cavity.def.density.value_or(cavity.def.fill == physics::CavityFill::Gas ? 1.2 : 1000.0);
}

CavityPressure pressureIn(const Cavity& cavity, const CavityState& state, double volume, double dt)
{
    if (cavity.wall.empty()) return {};
    const double v = std::max(volume, kSmallestVolume * cavity.restVolume);
    CavityPressure out{state.pressure, 0.0};
    if (cavity.def.fill == physics::CavityFill::Gas)
        out = {state.content / v - physics::kAtmosphere, state.content / (v * v)};
    if (cavity.def.fill == physics::CavityFill::Liquid) {
        const double stiffness = cavity.def.bulkModulus / cavity.restVolume;
        out = {stiffness * (state.content - v), stiffness};
    }
    const double flows = 1.0 / (1.0 + dt * out.stiffness * state.conductance);
    const double fading = kFading * cavity.restVolume, left = std::clamp(volume / fading, -1.0, 1.0);
    if (v != volume) out.stiffness = 0.0;
    if (out.pressure < 0.0) { // with the last of the volume it draws towards none
        out.stiffness = std::max(left, 0.0) * out.stiffness + (std::abs(left) < 1.0 ? -out.pressure / fading : 0.0);
        out.pressure *= left;
    }
    return {flows * out.pressure, flows * out.stiffness};
}

double contentAt(const Cavity& cavity, double pressure, double volume)
{
    const double v = std::max(volume, kSmallestVolume * cavity.restVolume);
    if (cavity.def.fill == physics::CavityFill::Gas) return (pressure + physics::kAtmosphere) * v;
    if (cavity.def.fill == physics::CavityFill::Source) return 0.0;
    return v + pressure * cavity.restVolume / cavity.def.bulkModulus;
}

double volumeOf(const Cavity& cavity, std::span<const Vec3> x)
{
    if (cavity.wall.empty()) return 0.0;
    const Vec3 origin = x[static_cast<std::size_t>(cavity.wall.front()[0])]; // far from 0, digits would be lost
    const auto at = [&](int node) { return x[static_cast<std::size_t>(node)] - origin; };
    double six = 0.0;
    for (const geometry::Triangle& t : cavity.wall) six += tripleProduct(at(t[0]), at(t[1]), at(t[2]));
    for (const CavityRim& rim : cavity.rims) {
        const Vec3 middle = middleOf(rim, x) - origin;
        for (const auto& [a, b] : rim.edges) six += tripleProduct(at(b), at(a), middle);
    }
    return six / 6.0;
}

double openingOf(const Cavity& cavity, std::span<const Vec3> x)
{
    struct Lid {
        Vec3 middle, area;
        double around = 0.0; ///< [m]
    };
    std::vector<Lid> lids;
    for (const CavityRim& rim : cavity.rims) {
        Lid& lid = lids.emplace_back();
        lid.middle = middleOf(rim, x);
        for (const auto& [a, b] : rim.edges) {
            const Vec3 from = x[static_cast<std::size_t>(a)], to = x[static_cast<std::size_t>(b)];
            lid.area += 0.5 * cross(from - lid.middle, to - lid.middle);
            lid.around += distance(from, to);
        }
    }
    double sum = 0.0;
    for (const Lid& lid : lids) {
        double open = length(lid.area);
        for (const Lid& other : lids)
            if (dot(lid.area, other.area) < 0.0)
                open = std::min(open, 0.5 * lid.around * distance(lid.middle, other.middle));
        sum += open;
    }
    return sum;
}

void addCavities(const std::vector<physics::CavityDef>& defs, const std::string& object, SoftModel& model)
{
    if (defs.empty()) return;
    const std::vector<std::array<int, 3>> neighbours = trianglesBeside(model.surface);
    const std::vector<int> parts = partsOf(neighbours);
    const std::vector<Space> spaces = spacesOf(model, neighbours, parts);
    const char* kind = isShell(model) ? "closed shells that face outwards" : "closed inner surfaces";
    const bool open = std::ranges::any_of(neighbours, [](const auto& of) { return std::ranges::min(of) < 0; });
    std::vector<int> taken(spaces.size(), -1);
    for (std::size_t c = 0; c < defs.size(); ++c) {
        const std::string name = text(object, ": cavities[", c, "]");
        const auto fits = [&](std::size_t s) {
            return taken[s] < 0 && (!defs[c].at || goesAround(model, parts, spaces[s].part, *defs[c].at));
        };
        std::size_t s = 0;
        while (s < spaces.size() && !fits(s)) ++s;
        if (s == spaces.size() && defs[c].at)
            fail(name, ".at must lie in a cavity of the mesh that no other entry has, got ", defs[c].at->x, " ",
                 defs[c].at->y, " ", defs[c].at->z, " m; the mesh has ", spaces.size(), " ", kind);
        if (s == spaces.size() && s > 0) fail(name, ": the mesh has only ", s, " ", kind);
        if (s == spaces.size()) fail(name, ": the mesh has no ", kind, open ? "; some edges have one triangle" : "");
        taken[s] = static_cast<int>(c);
    }
    model.wallOf.assign(model.surface.size(), -1);
    for (std::size_t t = 0; t < parts.size(); ++t)
        for (std::size_t s = 0; s < spaces.size(); ++s)
            if (parts[t] == spaces[s].part) model.wallOf[t] = taken[s];
    for (std::size_t c = 0; c < defs.size(); ++c) {
        Cavity& cavity = model.cavities.emplace_back();
        cavity.def = defs[c];
        for (std::size_t t = 0; t < parts.size(); ++t)
            if (model.wallOf[t] == static_cast<int>(c)) cavity.wall.push_back(fromTissue(model.surface[t], model));
        cavity.restVolume = volumeOf(cavity, model.rest);
        addInertia(cavity, model);
    }
}

std::vector<CavityState> cavitiesAtRest(const SoftModel& model)
{
    std::vector<CavityState> out;
    for (const Cavity& cavity : model.cavities)
        out.push_back(
            {.content = contentAt(cavity, cavity.def.pressure, cavity.restVolume), .pressure = cavity.def.pressure});
    return out;
}

std::vector<int> followCavities(const BodyTopology& topology, SoftModel& model)
{
    if (model.cavities.empty()) return {};
    const std::vector<std::array<int, 3>> neighbours = trianglesBeside(model.surface);
    const std::vector<int> parts = partsOf(neighbours);
    model.wallOf.assign(model.surface.size(), -1);
    std::vector<Mixture> mixtures(parts.size());
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const auto [element, face] = topology.boundaryFaces[t];
        Mixture& part = mixtures[static_cast<std::size_t>(parts[t])];
        part.several = part.several || std::ranges::any_of(neighbours[t], [](int other) { return other < 0; });
        if (topology.opened[t] != 0) continue;
        const int of = topology.wallOf[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)];
        model.wallOf[t] = of;
        part.outside = part.outside || of < 0;
        if (of < 0) continue;
        part.several = part.several || (part.cavity && *part.cavity != of);
        if (!part.cavity) part.cavity = of;
    }
    std::vector<char> before(model.cavities.size());
    std::vector<std::vector<std::array<int, 2>>> edges(model.cavities.size());
    for (std::size_t c = 0; c < model.cavities.size(); ++c) {
        before[c] = model.cavities[c].isOpen();
        model.cavities[c].wall.clear();
    }
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const Mixture& part = mixtures[static_cast<std::size_t>(parts[t])];
        const bool closed = part.cavity && !part.outside && !part.several;
        if (closed) model.wallOf[t] = *part.cavity; // what a cut has opened inside is wall as well
    }
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const int of = model.wallOf[t];
        if (of < 0) continue;
        const geometry::Triangle nodes = fromTissue(model.surface[t], model);
        model.cavities[static_cast<std::size_t>(of)].wall.push_back(nodes);
        for (std::size_t e = 0; e < 3; ++e) {
            const int other = neighbours[t][e];
            if (other >= 0 && model.wallOf[static_cast<std::size_t>(other)] == of) continue;
            const int a = model.surface[t][e], b = model.surface[t][(e + 1) % 3];
            edges[static_cast<std::size_t>(of)].push_back(isShell(model) ? std::array{a, b} : std::array{b, a});
        }
    }
    std::vector<int> opened;
    for (std::size_t c = 0; c < model.cavities.size(); ++c) {
        model.cavities[c].rims = rimsOf(edges[c]);
        if (before[c] == 0 && model.cavities[c].isOpen()) opened.push_back(static_cast<int>(c));
    }
    return opened;
}

} // namespace filasofia::engine
