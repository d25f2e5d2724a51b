#include "filasofia/engine/contact/keep_shells_apart.h"

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/find_contacts.h"
#include "filasofia/engine/contact/shell_passes.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace filasofia::engine {
namespace {

constexpr int kSweeps = 50;
// Changes of velocities that end the sweeps: [-], relative to the speed at which places may come nearer, and [m/s]
constexpr double kEnough = 1e-3, kStill = 1e-9;

template <class Visit> void forEachNode(const BodyPoint& point, const Visit& visit)
{
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
        visit(static_cast<std::size_t>(point.nodes[k]), point.weights[k]);
}

/// [1/kg]
double inverseMass(const Scene& scene, const BodyPoint& point)
{
    const SoftModel& model = scene.soft[point.body].model;
    double sum = 0.0;
    forEachNode(point, [&](std::size_t node, double weight) {
        if (!model.pins.hard[node]) sum += weight * weight / model.masses[node];
    });
    return sum;
}

Vec3 solvedVelocity(const Scene& scene, const BodyPoint& point)
{
    const SoftBody& body = scene.soft[point.body];
    Vec3 sum;
    forEachNode(point,
                [&](std::size_t node, double weight) { sum += weight * (body.state.v[node] + body.system.dv[node]); });
    return sum;
}

void push(const BodyPoint& point, Vec3 impulse, Scene& scene)
{
    SoftBody& body = scene.soft[point.body];
    forEachNode(point, [&](std::size_t node, double weight) {
        if (!body.model.pins.hard[node]) body.system.dv[node] += weight / body.model.masses[node] * impulse;
    });
}

/// Nodes that move as one.
class RigidZones {
public:
    explicit RigidZones(const Scene& scene) : sets_(0)
    {
        std::size_t count = 0;
        for (const SoftBody& body : scene.soft) {
            first_.push_back(count);
            count += body.state.x.size();
        }
        sets_ = DisjointSets(count);
        isHeld_.resize(count);
    }

    /// Joins the nodes of both places. Returns whether they were apart.
    bool join(const MissedContact& pass, const std::vector<SurfaceOwner>& owners)
    {
        int anchor = -1;
        bool joined = false;
        for (std::size_t side = 0; side < 2; ++side) {
            const SurfaceOwner& owner = owners[static_cast<std::size_t>(pass.at.surfaces[side])];
            const geometry::Embedding& embedding = owner.collision->embedding;
            for (int vertex : pass.at.vertices[side]) {
                if (vertex < 0) continue;
                const auto at = static_cast<std::size_t>(vertex);
                for (std::size_t n = 0; n < 4; ++n) {
                    if (embedding.weights[at][n] == 0.0) continue;
                    const int node = static_cast<int>(first_[owner.body]) + embedding.nodes[at][n];
                    isHeld_[static_cast<std::size_t>(node)] = 1;
                    if (anchor < 0) anchor = node;
                    if (sets_.find(node) == sets_.find(anchor)) continue;
                    sets_.join(node, anchor);
                    joined = true;
                }
            }
        }
        return joined;
    }

    /// Gives each zone the mean of its solved velocities, or none if one of its nodes is pinned.
    void move(Scene& scene)
    {
        struct Zone {
            double mass = 0.0;
            Vec3 momentum = {};
            bool pinned = false;
        };
        std::vector<Zone> zones(isHeld_.size());
        forEachNodeOfZones(scene, [&](const SoftBody& body, std::size_t node, std::size_t zone) {
            const double mass = body.model.masses[node];
            zones[zone].mass += mass;
            zones[zone].momentum += mass * (body.state.v[node] + body.system.dv[node]);
            zones[zone].pinned = zones[zone].pinned || body.model.pins.hard[node];
        });
        forEachNodeOfZones(scene, [&](SoftBody& body, std::size_t node, std::size_t zone) {
            const Zone& all = zones[zone];
            body.system.dv[node] = (all.pinned ? Vec3{} : 1.0 / all.mass * all.momentum) - body.state.v[node];
        });
    }

private:
    template <class Visit> void forEachNodeOfZones(Scene& scene, const Visit& visit)
    {
        for (std::size_t b = 0; b < scene.soft.size(); ++b)
            for (std::size_t node = 0; node < scene.soft[b].state.x.size(); ++node)
                if (const std::size_t number = first_[b] + node; isHeld_[number] != 0)
                    visit(scene.soft[b], node, static_cast<std::size_t>(sets_.find(static_cast<int>(number))));
    }

    std::vector<std::size_t> first_; ///< per soft body: the number of its first node
    DisjointSets sets_;
    std::vector<char> isHeld_; ///< per node: whether it belongs to a zone
};

/// Ends the step with zones that move as one. At last all nodes are one zone, or those of the passes are already.
std::vector<std::size_t> holdTogether(const StepContext& context, Scene& scene, Coupling& coupling)
{
    std::vector<std::size_t> held;
    RigidZones zones(scene);
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    bool joined = true;
    while (joined) {
        joined = false;
        for (const MissedContact& pass : findShellPasses(context, scene, coupling)) {
            joined = zones.join(pass, owners) || joined;
            held.insert(held.end(), pass.bodies.begin(), pass.bodies.end());
        }
        zones.move(scene);
    }
    std::ranges::sort(held);
    held.erase(std::unique(held.begin(), held.end()), held.end());
    return held;
}

/// Changes the solved velocities by impulses at these contacts until no two places come nearer than they may.
void pushApart(std::span<Constraint> contacts, Scene& scene)
{
    bool changed = true;
    for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
        changed = false;
        for (Constraint& each : contacts) {
            const Vec3 normal = each.frame[0];
            const double inverse = inverseMass(scene, each.sides[0]) + inverseMass(scene, each.sides[1]);
            if (!(inverse > 0.0)) continue;
            const double velocity =
                dot(normal, solvedVelocity(scene, each.sides[0]) - solvedVelocity(scene, each.sides[1]));
            const double impulse = std::max(0.0, each.impulse.x - (each.bias.x + velocity) / inverse);
            const double change = impulse - each.impulse.x;
            if (!(std::fabs(change) * inverse > kEnough * each.bias.x + kStill)) continue;
            changed = true;
            each.impulse.x = impulse;
            push(each.sides[0], change * normal, scene);
            push(each.sides[1], -change * normal, scene);
        }
    }
}

} // namespace

std::vector<std::size_t> keepShellsApart(const StepContext& context, Scene& scene, Coupling& coupling, int rounds)
{
    const auto collides = [](const SoftBody& body) { return isShell(body.model) && !body.model.collision.empty(); };
    if (std::ranges::none_of(scene.soft, collides)) return {};
    const std::size_t known = coupling.contactCount;
    // Without a deadline: as many rounds in a replay. They take microseconds, but for the searches.
    for (int round = 0; round < rounds; ++round) {
        const std::vector<MissedContact> found = findShellPasses(context, scene, coupling);
        if (found.empty()) return {};
        addMissed(context, found, scene, coupling);
        const std::span<Constraint> added = coupling.contacts().last(found.size());
        for (std::size_t i = 0; i < added.size(); ++i) {
            added[i].impulse = {};
            added[i].bias = {found[i].mayLose / context.dt, 0.0, 0.0};
        }
        pushApart(coupling.contacts().subspan(known), scene);
    }
    return holdTogether(context, scene, coupling);
}

} // namespace filasofia::engine
