#include "filasofia/engine/contact/shell_passes.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/may_cross.h"
#include "filasofia/engine/contact/surface_passes.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr double kMayLose = 0.9; ///< [-] how much of their distance two places may lose in a step
constexpr double kLeast = 0.25;  ///< [-] they come no nearer than this part of both proximities

/// Whether the solved velocity moves a body in this step.
bool followsSolve(const SoftModel& model)
{
    const auto* explicitEuler = std::get_if<physics::ExplicitEuler>(&model.integrator);
    return !explicitEuler || explicitEuler->symplectic;
}

class Finder {
public:
    Finder(const StepContext& context, const Scene& scene, Coupling& coupling)
        : context_(context), scene_(scene), detection_(coupling.detection), owners_(surfaceOwners(scene)),
          usable_(owners_.size())
    {
    }

    std::vector<MissedContact> run()
    {
        std::vector<std::array<int, 2>> pairs;
        std::vector<char> wanted(owners_.size());
        for (int i = 0; i < static_cast<int>(owners_.size()); ++i)
            for (int k = i; k < static_cast<int>(owners_.size()); ++k)
                if (mayMeet(i, k)) {
                    pairs.push_back({i, k});
                    wanted[static_cast<std::size_t>(i)] = wanted[static_cast<std::size_t>(k)] = 1;
                }
        for (std::size_t i = 0; i < wanted.size(); ++i)
            if (wanted[i] != 0) useSolved(i);
        std::vector<MissedContact> out;
        for (const std::array<int, 2>& pair : pairs)
            if (usable_[static_cast<std::size_t>(pair[0])] != 0 && usable_[static_cast<std::size_t>(pair[1])] != 0)
                find(pair, out);
        return out;
    }

private:
    [[nodiscard]] const SurfaceOwner& ownerOf(int i) const { return owners_[static_cast<std::size_t>(i)]; }
    [[nodiscard]] CollisionSurface& surfaceOf(int i) const { return detection_.surfaces[static_cast<std::size_t>(i)]; }

    [[nodiscard]] bool mayMeet(int i, int k) const
    {
        const SurfaceOwner &one = ownerOf(i), &two = ownerOf(k);
        if (!one.soft || !two.soft) return false;
        const SoftModel &first = scene_.soft[one.body].model, &second = scene_.soft[two.body].model;
        if (!(isShell(first) || isShell(second)) || !followsSolve(first) || !followsSolve(second)) return false;
        const CollisionSurface &a = surfaceOf(i), &b = surfaceOf(k);
        return a.shape->triangleFaces && b.shape->triangleFaces && mayCollide(a, b);
    }

    /// Gives a surface the solved velocities, and notes whether its body will be moved by them.
    void useSolved(std::size_t i)
    {
        CollisionSurface& surface = detection_.surfaces[i];
        const SoftBody& body = scene_.soft[owners_[i].body];
        solved_.resize(body.state.v.size());
        for (std::size_t n = 0; n < solved_.size(); ++n) solved_[n] = body.state.v[n] + body.system.dv[n];
        for (std::size_t at = 0; at < surface.v.size(); ++at)
            surface.v[at] = valueAt(at, owners_[i].collision->embedding, solved_);
        for (std::size_t n = 0; n < solved_.size(); ++n) solved_[n] = body.state.x[n] + context_.dt * solved_[n];
        usable_[i] = usable(solved_) ? 1 : 0;
    }

    void find(std::array<int, 2> pair, std::vector<MissedContact>& out)
    {
        for (const Proximity& each : findSurfacePasses(context_.dt, surfaceOf(pair[0]), surfaceOf(pair[1]), pair,
                                                       detection_.scratch, context_.pool))
            add(each, out);
    }

    void add(const Proximity& pass, std::vector<MissedContact>& out) const
    {
        const std::array<const SurfaceOwner*, 2> sides{&ownerOf(pass.surfaces[0]), &ownerOf(pass.surfaces[1])};
        if (holdsTogether(scene_, {*sides[0], pass.vertices[0]}, {*sides[1], pass.vertices[1]})) return;
        const double least =
            kLeast * (surfaceOf(pass.surfaces[0]).shape->proximity + surfaceOf(pass.surfaces[1]).shape->proximity);
        out.push_back({.at = pass,
                       .bodies = {sides[0]->body, sides[1]->body},
                       .mayLose = std::clamp(pass.gap - least, 0.0, kMayLose * pass.gap)});
    }

    const StepContext& context_;
    const Scene& scene_;
    ContactDetection& detection_;
    std::vector<SurfaceOwner> owners_;
    std::vector<char> usable_; ///< per surface
    std::vector<Vec3> solved_; ///< scratch, per node
};

} // namespace

std::vector<MissedContact> findShellPasses(const StepContext& context, const Scene& scene, Coupling& coupling)
{
    return Finder(context, scene, coupling).run();
}

} // namespace filasofia::engine
