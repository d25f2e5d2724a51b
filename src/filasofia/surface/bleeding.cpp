#include "filasofia/surface/bleeding.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/validate.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace filasofia::surface {
namespace {

constexpr std::uint8_t kWhole = 0;   ///< no vessel is open
constexpr std::uint8_t kOpened = 1;  ///< bleeds on its opened triangles
constexpr std::uint8_t kInjured = 2; ///< bleeds on all of its triangles
constexpr double kLandings = 0.1;    ///< [s] between two looks where drops land
constexpr double kNew = -1.0;        ///< vessels have just been opened
constexpr double kPouring = 0.1;     ///< [s] after which what was poured is no stream any more

/// In [0, 1), the same for the same node.
double drawn(int node)
{
    Hasher hasher;
    hasher.add(static_cast<std::uint64_t>(node) + 1);
    return static_cast<double>(hasher.value() >> 11) * 0x1p-53;
}

/// A Poisson-distributed number over its mean, by inversion; near 1 if many are expected.
double unevenness(double mean, double drawn)
{
    constexpr double kMany = 50.0;
    if (!(mean < kMany)) return 1.0;
    if (mean <= 0.0) return 0.0;
    double chance = std::exp(-mean), sum = chance;
    int count = 0;
    while (drawn > sum && count < 4 * static_cast<int>(kMany)) {
        chance *= mean / ++count;
        sum += chance;
    }
    return count / mean;
}

/// Calls visit(vertex) for each within `radius` of `place`.
template <class Visit> void forEachNear(std::span<const Vec3> places, Vec3 place, double radius, const Visit& visit)
{
    for (std::size_t v = 0; v < places.size(); ++v)
        if (distance(places[v], place) <= radius) visit(v);
}

} // namespace

Bleeding::Bleeding(const BleedingDef& def, std::vector<geometry::Triangle> skin, const std::string& object)
    : def_(def), skin_(std::move(skin))
{
    validate(def_, object);
    if (skin_.empty()) fail(object, ": needs a surface of triangles, got none");
    set(skin_, std::vector<std::uint8_t>(skin_.size(), 0));
}

void Bleeding::follow(const frame::Boundary& boundary)
{
    if (boundary.revision == revision_) return;
    if (boundary.revision < revision_) { // the body was put back to its start
        Bleeding start(def_, skin_, "bleeding");
        start.perfusion_ = perfusion_;
        *this = std::move(start);
    }
    revision_ = boundary.revision;
    if (boundary.revision > 0) set(boundary.triangles, boundary.opened);
}

void Bleeding::set(std::vector<geometry::Triangle> triangles, std::vector<std::uint8_t> opened)
{
    const BodySurface::Change change = surface_.set(std::move(triangles));
    carry(change.now);
    opened_ = std::move(opened);
    untilLandings_ = 0.0;
    const std::vector<geometry::Triangle>& local = surface_.topology().triangles;
    for (std::size_t t = 0; t < local.size(); ++t)
        for (const int v : local[t])
            if (opened_[t] != 0 && wound_[v] == kWhole) {
                wound_[v] = kOpened;
                vessels_[v] = kNew;
            }
    if (!change.now.empty()) spread(change.fresh);
}

/// What lies and bleeds on nodes stays with them.
void Bleeding::carry(const std::vector<int>& now)
{
    const FilmContent content = std::move(content_);
    const std::vector<std::uint8_t> wound = std::move(wound_);
    const std::vector<double> vessels = std::move(vessels_);
    content_.volume.assign(surface_.vertices(), 0.0);
    content_.aged.assign(surface_.vertices(), 0.0);
    wound_.assign(surface_.vertices(), kWhole);
    vessels_.assign(surface_.vertices(), 0.0);
    for (std::size_t v = 0; v < now.size(); ++v) {
        if (now[v] < 0) { // its piece has gone, or it is inside the tissue
            balance_.carriedOff += content.volume[v];
            continue;
        }
        content_.volume[now[v]] = content.volume[v];
        content_.aged[now[v]] = content.aged[v];
        wound_[now[v]] = wound[v];
        vessels_[now[v]] = vessels[v];
    }
}

/// A new vertex took its area from those around it, and takes a part of their blood: as much as makes its volume the
/// mean of theirs, but from each at most a half.
void Bleeding::spread(const std::vector<int>& fresh)
{
    const FilmTopology& topology = surface_.topology();
    for (const int v : fresh) {
        double sum = 0.0;
        int count = 0;
        for (int e = topology.first[v]; e < topology.first[v + 1]; ++e) {
            sum += content_.volume[topology.next[e]];
            ++count;
        }
        if (sum <= 0.0) continue;
        const double share = std::min(0.5, 1.0 / (count + 1));
        for (int e = topology.first[v]; e < topology.first[v + 1]; ++e) {
            const int from = topology.next[e];
            const double volume = share * content_.volume[from], aged = share * content_.aged[from];
            content_.volume[from] -= volume;
            content_.aged[from] -= aged;
            content_.volume[v] += volume;
            content_.aged[v] += aged;
        }
    }
}

void Bleeding::close(std::span<const std::uint8_t> nodes)
{
    for (std::size_t v = 0; v < surface_.vertices(); ++v) {
        const auto node = static_cast<std::size_t>(surface_.nodes()[v]);
        if (node < nodes.size() && nodes[node] != 0) vessels_[v] = 0.0;
    }
}

void Bleeding::apply(const BloodCommand& command, std::span<const Vec3> positions)
{
    surface_.gather(positions, places_);
    if (const auto* perfuse = std::get_if<Perfuse>(&command)) perfusion_ = perfuse->share;
    if (const auto* suck = std::get_if<Suck>(&command))
        suction_ = suck->rate > 0.0 ? std::optional(*suck) : std::nullopt;
    if (const auto* injure = std::get_if<Injure>(&command))
        forEachNear(places_, injure->place, injure->radius, [&](std::size_t v) {
            wound_[v] = kInjured;
            vessels_[v] = kNew;
        });
    if (const auto* seal = std::get_if<Seal>(&command))
        forEachNear(places_, seal->place, seal->radius, [&](std::size_t v) { vessels_[v] = 0.0; });
    if (const auto* poured = std::get_if<Pour>(&command)) pour(*poured);
    if (const auto* rinse = std::get_if<Rinse>(&command)) {
        if (std::isinf(rinse->rate)) // at once
            balance_.rinsed += takeAway(rinse->place, rinse->radius, rinse->rate);
        else
            rinsing_ = rinse->rate > 0.0 ? std::optional(*rinse) : std::nullopt;
    }
}

void Bleeding::pour(const Pour& what)
{
    if (places_.empty() || what.volume == 0.0) return;
    std::vector<std::size_t> on;
    forEachNear(places_, what.place, what.radius, [&](std::size_t v) { on.push_back(v); });
    if (on.empty()) {
        const auto far = [&](Vec3 place) { return lengthSquared(place - what.place); };
        on = {static_cast<std::size_t>(std::ranges::min_element(places_, {}, far) - places_.begin())};
    }
    for (const std::size_t v : on) content_.volume[v] += what.volume / static_cast<double>(on.size());
    poured_ += what.volume;
    balance_.welled += what.volume;
}

void Bleeding::step(std::span<const Vec3> positions, Vec3 gravity, double dt)
{
    sincePour_ += dt;
    if (poured_ > 0.0)
        pourRate_ = std::exchange(poured_, 0.0) / std::min(std::exchange(sincePour_, 0.0), kPouring);
    else if (sincePour_ > kPouring)
        pourRate_ = 0.0;
    balance_.rate = pourRate_;
    if (dt <= 0.0 || idle()) return;
    surface_.gather(positions, places_);
    measure(surface_.topology(), places_, gravity, geometry_);
    if (untilLandings_ <= 0.0) {
        findLandings(surface_.topology(), places_, gravity, content_, geometry_);
        untilLandings_ = kLandings;
    }
    untilLandings_ -= dt;
    well(dt);
    if (rinsing_) balance_.rinsed += takeAway(rinsing_->place, rinsing_->radius, rinsing_->rate * dt);
    if (suction_) balance_.sucked += takeAway(suction_->place, suction_->radius, suction_->rate * dt);
    const FilmLiquid liquid{.viscosity = def_.viscosity,
                            .hardening = def_.clottingTime,
                            .density = def_.density,
                            .surfaceTension = def_.surfaceTension,
                            .clinging = def_.clinging};
    balance_.dripped += flow(surface_.topology(), geometry_, liquid, dt, content_, order_);
}

void Bleeding::measureWounds()
{
    woundArea_.assign(surface_.vertices(), 0.0);
    const std::vector<geometry::Triangle>& triangles = surface_.topology().triangles;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& [a, b, c] = triangles[t];
        const double third = length(cross(places_[b] - places_[a], places_[c] - places_[a])) / 6.0;
        for (const int v : {a, b, c})
            if (wound_[v] == kInjured || (wound_[v] == kOpened && opened_[t] != 0)) woundArea_[v] += third;
    }
    for (std::size_t v = 0; v < surface_.vertices(); ++v)
        if (vessels_[v] < 0.0) vessels_[v] = unevenness(def_.vesselDensity * woundArea_[v], drawn(surface_.nodes()[v]));
}

void Bleeding::well(double dt)
{
    measureWounds();
    // The integral of the flux over the step, while it falls exponentially.
    const double lasting = -def_.clottingTime * std::expm1(-dt / def_.clottingTime);
    const double left = std::exp(-dt / def_.clottingTime);
    for (std::size_t v = 0; v < surface_.vertices(); ++v) {
        if (vessels_[v] == 0.0) continue;
        const double flux = def_.flux * perfusion_ * vessels_[v] * woundArea_[v];
        if (std::isfinite(flux)) {
            content_.volume[v] += flux * lasting;
            balance_.welled += flux * lasting;
            balance_.rate += flux * left;
        }
        vessels_[v] *= left;
        if (vessels_[v] < 1e-6) vessels_[v] = 0.0;
    }
}

/// Takes at most `most` [m^3] of what lies around a place, evenly; returns how much it took.
double Bleeding::takeAway(Vec3 place, double radius, double most)
{
    double there = 0.0, taken = 0.0;
    forEachNear(places_, place, radius, [&](std::size_t v) { there += content_.volume[v]; });
    if (there <= 0.0) return 0.0;
    const double share = std::min(most / there, 1.0);
    forEachNear(places_, place, radius, [&](std::size_t v) {
        const double left = share < 1.0 ? content_.volume[v] * (1.0 - share) : 0.0;
        taken += content_.volume[v] - left;
        content_.volume[v] = left;
        content_.aged[v] *= 1.0 - share;
    });
    return taken;
}

bool Bleeding::idle() const
{
    return std::ranges::all_of(vessels_, [](double each) { return each == 0.0; }) &&
           std::ranges::all_of(content_.volume, [](double each) { return each == 0.0; });
}

BloodBalance Bleeding::balance() const
{
    BloodBalance now = balance_;
    now.onTissue = std::accumulate(content_.volume.begin(), content_.volume.end(), 0.0);
    return now;
}

std::vector<float> Bleeding::thickness() const
{
    std::vector<double> out(surface_.vertices(), 0.0);
    for (std::size_t v = 0; v < out.size(); ++v)
        if (v < geometry_.area.size() && geometry_.area[v] > 0.0) out[v] = content_.volume[v] / geometry_.area[v];
    return surface_.byNode(out);
}

} // namespace filasofia::surface
