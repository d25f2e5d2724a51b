#include "filasofia/surface/burning.h"

#include "filasofia/core/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::surface {
namespace {

constexpr double kBoiling = 373.15;  ///< [K]
constexpr double kHarmless = 316.15; ///< [K], 43 degrees Celsius: below it nothing is damaged within hours
constexpr double kCool = 1e-3;       ///< [K] above rest, from which on nothing is computed
constexpr double kMostDamage = 1e9;  ///< [-], keeps the number finite
constexpr double kDecades = 7.0; ///< damage for one level, 23 K at 60 degrees: from cold to damaged, and on to boiling

} // namespace

Burning::Burning(const BurningDef& def, std::vector<geometry::Triangle> skin, const std::string& object,
                 std::shared_ptr<const geometry::TetMesh> inside)
    : def_(def), skin_(std::move(skin))
{
    validate(def_, object);
    if (skin_.empty()) fail(object, ": needs a surface of triangles, got none");
    balance_.peak = def_.temperature;
    if (def_.tissue) {
        if (!inside) fail(object, ": tissue needs a body of tetrahedra");
        inside_.emplace(std::move(inside), def_.depth);
    }
    set(skin_, {});
}

void Burning::follow(const frame::Boundary& boundary)
{
    if (boundary.revision == revision_) return;
    if (boundary.revision < revision_) // the body was put back to its start
        *this = Burning(def_, skin_, "burning", inside_ ? inside_->mesh() : nullptr);
    revision_ = boundary.revision;
    if (boundary.revision > 0) set(boundary.triangles, boundary.rest);
}

/// Temperature, water and damage stay with the nodes. A new node is as those around it; where none is known it comes
/// from inside, which is at rest.
void Burning::set(std::vector<geometry::Triangle> triangles, std::span<const Vec3> rest)
{
    const double before = stored();
    const BodySurface::Change change = surface_.set(std::move(triangles));
    std::vector<std::uint8_t> known(surface_.vertices(), 1);
    for (const int v : change.fresh) known[v] = 0;
    const FilmTopology& topology = surface_.topology();
    const auto carry = [&](std::vector<double>& values, double fresh, double most) {
        const std::vector<double> old = std::move(values);
        values.assign(surface_.vertices(), fresh);
        for (std::size_t v = 0; v < change.now.size(); ++v)
            if (change.now[v] >= 0) values[change.now[v]] = old[v];
        for (const int v : change.fresh) {
            double sum = 0.0;
            int count = 0;
            for (int e = topology.first[v]; e < topology.first[v + 1]; ++e)
                if (known[topology.next[e]] != 0) {
                    sum += std::min(values[topology.next[e]], most);
                    ++count;
                }
            if (count > 0) values[v] = sum / count;
        }
    };
    carry(warmth_, 0.0, std::numeric_limits<double>::infinity());
    carry(water_, 1.0, 1.0);
    carry(damage_, 0.0, 1.0); // char beside it is as one that is damaged: the new node is not, unless all around it are
    carry(intact_, 1.0, 1.0);
    for (const int v : change.fresh) intact_[v] = 1.0; // what lies behind it is known, and no more is denatured yet
    if (inside_) surface_.gather(rest.empty() ? std::span<const Vec3>(inside_->mesh()->nodes) : rest, rest_);
    area_.clear();
    if (rest.empty()) return;
    measureRest(rest);
    balance_.carriedOff += before - stored();
}

/// Heat flows as in the tissue at rest, so that stretching it changes neither its mass nor its temperature.
void Burning::measureRest(std::span<const Vec3> positions)
{
    surface_.gather(positions, places_);
    FilmGeometry geometry;
    measure(surface_.topology(), places_, {0, -1, 0}, geometry); // gravity does not matter here
    area_ = std::move(geometry.area);
    capacity_.resize(area_.size());
    for (std::size_t v = 0; v < area_.size(); ++v)
        capacity_[v] = def_.density * def_.heatCapacity * def_.depth * area_[v];
    conductance_ = std::move(geometry.conductance);
    for (double& each : conductance_) each *= def_.conductivity * def_.depth;
}

void Burning::apply(const Heat& command, std::span<const Vec3>)
{
    if (command.power > 0.0)
        sources_[command.source] = command;
    else
        sources_.erase(command.source);
}

void Burning::step(std::span<const Vec3> positions, Vec3, double dt)
{
    fumes_.clear();
    if (dt <= 0.0 || idle()) return;
    if (area_.empty()) measureRest(positions);
    surface_.gather(positions, places_);
    before_ = warmth_;
    conduct(surface_.topology(), conductance_, capacity_, dt, warmth_);
    takeSources(dt);
    warm(dt);
    fume();
    countTips(dt);
    hurt(dt);
    if (inside_) denature(dt);
}

void Burning::take(std::span<const HeatShare> shares, double power, double limit)
{
    for (const HeatShare& each : shares) {
        if (!(each.share > 0.0)) continue;
        power_[each.vertex] += each.share * power;
        limit_[each.vertex] = std::max(limit_[each.vertex], limit - def_.temperature);
    }
}

void Burning::takeSources(double dt)
{
    power_.assign(surface_.vertices(), 0.0);
    limit_.assign(surface_.vertices(), 0.0);
    std::vector<HeatShare> shares;
    for (const auto& [number, heat] : sources_) {
        divideSource(surface_.topology().triangles, places_, {.points = {heat.place}, .radius = heat.radius}, shares);
        take(shares, heat.power, heat.limit);
    }
    for (TipHeat& tip : tips_) {
        for (HeatShare& each : tip.shares) { // from nodes to vertices
            const auto found = std::ranges::lower_bound(surface_.nodes(), each.vertex);
            const bool here = found != surface_.nodes().end() && *found == each.vertex;
            each = here ? HeatShare{static_cast<int>(found - surface_.nodes().begin()), each.share} : HeatShare{};
        }
        take(tip.shares, tip.energy / dt, tip.limit);
    }
}

/// What each tip gave: tissue that takes less than it is offered takes less of each.
void Burning::countTips(double dt)
{
    for (const TipHeat& tip : std::exchange(tips_, {}))
        for (const HeatShare& each : tip.shares)
            if (each.share > 0.0)
                taken_[tip.electrode] += each.share * tip.energy * used_[each.vertex] / (power_[each.vertex] * dt);
}

/// Pennes' equation at each vertex: power, perfusion, loss; and water that boils. Damaged tissue is not perfused.
void Burning::warm(double dt)
{
    const double wet = def_.density * def_.depth * def_.water * kLatentHeat;      // [J/m^2]
    const double perfused = def_.perfusion * def_.bloodHeatCapacity * def_.depth; // [W/(m^2 K)]
    used_.assign(warmth_.size(), 0.0);
    steamed_.assign(warmth_.size(), 0.0);
    for (std::size_t v = 0; v < warmth_.size(); ++v) {
        if (!(capacity_[v] > 0.0)) continue;
        const double flowing = perfused * std::exp(-damage_[v]), loss = flowing + def_.loss;
        const HeatedStep now = heatVertex({.capacity = capacity_[v],
                                           .loss = loss * area_[v],
                                           .latent = wet * area_[v] * water_[v],
                                           .boiling = kBoiling - def_.temperature,
                                           .limit = limit_[v]},
                                          warmth_[v], power_[v], dt);
        warmth_[v] = now.warmth;
        used_[v] = now.delivered;
        steamed_[v] = now.boiled;
        balance_.delivered += now.delivered;
        balance_.boiled += now.boiled;
        if (loss > 0.0) {
            balance_.perfused += now.lost * flowing / loss;
            balance_.lost += now.lost * def_.loss / loss;
        }
        const double gone = now.boiled > 0.0 ? now.boiled / (wet * area_[v]) : 0.0;
        water_[v] = water_[v] - gone > 1e-12 ? water_[v] - gone : 0.0;
    }
}

/// Tissue at the boiling point smokes, and steams: one fume per cube of a centimetre.
void Burning::fume()
{
    constexpr double kCube = 0.01; // [m]
    const double boiling = kBoiling - def_.temperature;
    std::map<std::array<double, 3>, Fume> places;
    for (std::size_t v = 0; v < warmth_.size(); ++v) {
        if (!(warmth_[v] >= boiling - kCool) || !(used_[v] + steamed_[v] > 0.0)) continue;
        const Vec3 at = places_[v];
        Fume& fume = places[{std::floor(at.x / kCube), std::floor(at.y / kCube), std::floor(at.z / kCube)}];
        const double weight = used_[v] + steamed_[v], sum = fume.taken + fume.boiled + weight;
        fume.place = fume.place + weight / sum * (at - fume.place);
        fume.taken += used_[v];
        fume.boiled += steamed_[v];
        balance_.fuming += used_[v];
    }
    for (const auto& [cube, fume] : places) fumes_.push_back(fume);
}

void Burning::hurt(double dt)
{
    for (std::size_t v = 0; v < warmth_.size(); ++v) {
        const double from = def_.temperature + before_[v], to = def_.temperature + warmth_[v];
        const double more = damageOver(from, to, dt, def_.frequencyFactor, def_.activationEnergy);
        damage_[v] = std::min(damage_[v] + more, kMostDamage);
        balance_.peak = std::max(balance_.peak, to);
    }
}

void Burning::denature(double dt)
{
    const HeatedTissueDef& def = *def_.tissue;
    for (std::size_t v = 0; v < warmth_.size(); ++v)
        intact_[v] *= std::exp(-damageOver(def_.temperature + before_[v], def_.temperature + warmth_[v], dt,
                                           def.frequencyFactor, def.activationEnergy));
    sinceSpread_ += dt;
    if (sinceSpread_ < 1.0 / def.rate - 1e-9) return;
    sinceSpread_ = 0.0;
    for (HeatedPart& each : inside_->spread(surface_.topology().triangles, surface_.nodes(), rest_, intact_))
        parts_.push_back(std::move(each));
}

double Burning::stored() const
{
    double sum = 0.0;
    for (std::size_t v = 0; v < area_.size(); ++v) sum += capacity_[v] * warmth_[v];
    return sum;
}

bool Burning::idle() const
{
    return sources_.empty() && tips_.empty() && def_.temperature <= kHarmless &&
           std::ranges::all_of(warmth_, [](double each) { return std::abs(each) < kCool; });
}

HeatBalance Burning::balance() const
{
    HeatBalance now = balance_;
    now.stored = stored();
    now.hottest = def_.temperature + std::ranges::max(warmth_);
    for (std::size_t v = 0; v < area_.size(); ++v) {
        if (damage_[v] >= 1.0) now.burnt += area_[v];
        if (water_[v] == 0.0) now.charred += area_[v];
    }
    return now;
}

std::vector<float> Burning::levels() const
{
    static const double kMost = std::log10(kMostDamage) / kDecades;
    std::vector<double> out(surface_.vertices());
    for (std::size_t v = 0; v < out.size(); ++v)
        out[v] = std::clamp(std::log10(damage_[v]) / kDecades, -1.0, kMost) + (1.0 - water_[v]);
    return surface_.byNode(out);
}

std::vector<std::uint8_t> Burning::burnt() const
{
    std::vector<std::uint8_t> out(static_cast<std::size_t>(nodesNeeded()), 0);
    for (std::size_t v = 0; v < damage_.size(); ++v)
        if (damage_[v] >= 1.0) out[static_cast<std::size_t>(surface_.nodes()[v])] = 1;
    return out;
}

std::vector<float> Burning::damage() const { return surface_.byNode(damage_); }

} // namespace filasofia::surface
