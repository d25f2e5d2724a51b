#include "filasofia/metric/measure.h"

#include <algorithm>
#include <cmath>

namespace filasofia::metric {
namespace {

const char* const kTouchedNothing = "the tool touched nothing";

struct Force {
    double time;
    double size; ///< [N]
    int contacts;
    double steady; ///< [N], magnitude of the mean over forceWindow
};

/// In an impact, the force of a step is m dv / dt: it grows as steps get shorter, and means nothing. Its mean over some
/// steps does not. A sample stands for the time since the previous one.
void steady(std::vector<Force>& forces, const std::vector<Vec3>& vectors, double window)
{
    std::size_t first = 0; // first sample within the window
    for (std::size_t i = 0; i < forces.size(); ++i) {
        while (first < i && forces[first].time <= forces[i].time - window + 1e-9) ++first;
        Vec3 impulse = {};
        double time = 0.0;
        for (std::size_t k = std::max<std::size_t>(1, first); k <= i; ++k) {
            const double dt = std::min(forces[k].time - forces[k - 1].time, window);
            impulse += dt * vectors[k];
            time += dt;
        }
        forces[i].steady = time > 0.0 ? length(impulse / time) : forces[i].size;
    }
}

/// The samples that have a force, in increasing order of time. Forces are filtered only by those means.
std::vector<Force> forcesOf(const Material& m, const Track* track)
{
    std::vector<Force> forces;
    std::vector<Vec3> vectors;
    if (!track || !track->force) return forces;
    for (const Sample& sample : track->samples)
        if (std::isfinite(sample.time) && isFinite(sample.force) &&
            (forces.empty() || sample.time > forces.back().time)) {
            const double size = length(sample.force);
            forces.push_back({sample.time, size, sample.contacts, size});
            vectors.push_back(sample.force);
        }
    steady(forces, vectors, m.def.forceWindow);
    return forces;
}

std::vector<Force> forcesOf(const Material& m) { return forcesOf(m, m.tool); }

/// The forces of every instrument, including a scope: harm counts whichever instrument did it.
std::vector<std::vector<Force>> forcesOfAll(const Material& m)
{
    std::vector<std::vector<Force>> all;
    for (const Track& track : m.session.tracks)
        if (track.role != Role::Other)
            if (auto forces = forcesOf(m, &track); forces.size() > 1) all.push_back(std::move(forces));
    return all;
}

std::string noForces(const Material& m, const std::vector<Force>& forces)
{
    if (!m.tool) return "no tool was observed";
    if (!m.tool->force) return "forces were not observed";
    return forces.size() < 2 ? "needs at least two samples with a force" : "";
}

/// Calls take(before, after) for every two consecutive samples without a gap between them.
template <class Take> void forEachPair(const Material& m, const std::vector<Force>& forces, Take&& take)
{
    for (std::size_t i = 1; i < forces.size(); ++i)
        if (forces[i].time - forces[i - 1].time <= m.def.maximumGap) take(forces[i - 1], forces[i]);
}

/// The integral of the force's power [N^p s] over the time [s] in contact.
struct Sum {
    double value = 0.0, time = 0.0;
};
Sum sumOf(const Material& m, const std::vector<Force>& forces, int power)
{
    Sum sum;
    forEachPair(m, forces, [&](const Force& a, const Force& b) {
        if (b.contacts <= 0) return; // a sample stands for the interval that ends with it
        const double dt = b.time - a.time;
        sum.value += 0.5 * dt * (std::pow(a.size, power) + std::pow(b.size, power));
        sum.time += dt;
    });
    return sum;
}

Value average(const Material& m, int power)
{
    const std::vector<Force> forces = forcesOf(m);
    if (std::string reason = noForces(m, forces); !reason.empty()) return none(reason);
    const Sum sum = sumOf(m, forces, power);
    if (sum.time <= 0.0) return none(kTouchedNothing);
    return found(std::pow(sum.value / sum.time, 1.0 / power));
}

/// The times in which any instrument is above the limit; the force is interpolated linearly between samples.
struct Excess {
    double time = 0.0;
    int times = 0;
    std::optional<double> first = {};
};
Excess excessOf(const Material& m, const std::vector<std::vector<Force>>& instruments, double limit)
{
    std::vector<std::pair<double, double>> above; // start and end
    for (const std::vector<Force>& forces : instruments)
        forEachPair(m, forces, [&](const Force& a, const Force& b) {
            if (a.steady <= limit && b.steady <= limit) return;
            const double crossing = a.time + (b.time - a.time) * (limit - a.steady) / (b.steady - a.steady);
            above.emplace_back(a.steady > limit ? a.time : crossing, b.steady > limit ? b.time : crossing);
        });
    std::ranges::sort(above);
    Excess excess;
    double end = -1e300; // end of the last time above the limit
    for (const auto& [from, to] : above) {
        if (from > end) ++excess.times;
        if (!excess.first) excess.first = from;
        excess.time += std::max(0.0, to - std::max(from, end));
        end = std::max(end, to);
    }
    return excess;
}

Value overLimit(const Material& m, double (*of)(const Excess&))
{
    if (!m.session.forceLimit) return none("the case specifies no force limit of the tissue");
    const auto instruments = forcesOfAll(m);
    if (instruments.empty()) return none(noForces(m, forcesOf(m)));
    const Excess excess = excessOf(m, instruments, *m.session.forceLimit);
    return found(of(excess), excess.first);
}

struct Contact {
    double start = 0.0, end = 0.0, peak = 0.0;
};

/// A contact begins at the sample before the first one with a contact.
std::vector<Contact> contactsOf(const Material& m, const std::vector<Force>& forces)
{
    std::vector<Contact> contacts;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const Force& force = forces[i];
        if (force.contacts <= 0) continue;
        const bool gap = i == 0 || force.time - forces[i - 1].time > m.def.maximumGap;
        const double start = gap ? force.time : forces[i - 1].time;
        if (contacts.empty() || start > contacts.back().end + m.def.contactPause)
            contacts.push_back({start, start, 0.0});
        contacts.back().end = force.time;
        contacts.back().peak = std::max(contacts.back().peak, force.steady);
    }
    return contacts;
}

Value ofContacts(const Material& m, Value (*of)(const std::vector<Contact>&))
{
    const std::vector<Force> forces = forcesOf(m);
    if (std::string reason = noForces(m, forces); !reason.empty()) return none(reason);
    return of(contactsOf(m, forces));
}

} // namespace

Value maxForce(const Material& m)
{
    const auto instruments = forcesOfAll(m);
    if (instruments.empty()) return none(noForces(m, forcesOf(m)));
    Value most = found(0.0);
    for (const std::vector<Force>& forces : instruments) {
        const auto largest = std::ranges::max_element(forces, {}, &Force::steady);
        if (largest->steady > *most.value) most = found(largest->steady, largest->time);
    }
    return most;
}

Value meanForce(const Material& m) { return average(m, 1); }
Value rmsForce(const Material& m) { return average(m, 2); }

Value forceImpulse(const Material& m)
{
    const std::vector<Force> forces = forcesOf(m);
    if (std::string reason = noForces(m, forces); !reason.empty()) return none(reason);
    return found(sumOf(m, forces, 1).value);
}

Value timeAboveLimit(const Material& m)
{
    return overLimit(m, [](const Excess& excess) { return excess.time; });
}
Value timesAboveLimit(const Material& m)
{
    return overLimit(m, [](const Excess& excess) { return static_cast<double>(excess.times); });
}

Value contactCount(const Material& m)
{
    return ofContacts(m, [](const std::vector<Contact>& contacts) {
        return contacts.empty() ? found(0.0) : found(static_cast<double>(contacts.size()), contacts.front().start);
    });
}

Value contactTime(const Material& m)
{
    const std::vector<Force> forces = forcesOf(m);
    if (std::string reason = noForces(m, forces); !reason.empty()) return none(reason);
    return found(sumOf(m, forces, 1).time);
}

Value longestContact(const Material& m)
{
    return ofContacts(m, [](const std::vector<Contact>& contacts) {
        Value longest = found(0.0);
        for (const Contact& contact : contacts)
            if (contact.end - contact.start > *longest.value)
                longest = found(contact.end - contact.start, contact.start);
        return longest;
    });
}

Value meanContactPeak(const Material& m)
{
    return ofContacts(m, [](const std::vector<Contact>& contacts) {
        if (contacts.empty()) return none(kTouchedNothing);
        double sum = 0.0;
        for (const Contact& contact : contacts) sum += contact.peak;
        return found(sum / static_cast<double>(contacts.size()));
    });
}

} // namespace filasofia::metric
