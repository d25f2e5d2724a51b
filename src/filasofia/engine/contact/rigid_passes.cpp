#include "filasofia/engine/contact/rigid_passes.h"

#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/may_cross.h"
#include "filasofia/engine/contact/surface_passes.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kSlow = 0.25; ///< [-] of the radius: contacts see to what moves by less in a step

/// The velocity of a rigid element in the step as it was solved.
struct SolvedMotion {
    Vec3 centre, velocity, spin;
    explicit SolvedMotion(const RigidPlanElement& planned)
        : centre(planned.centre), velocity(planned.velocity + planned.change.linear + planned.beyond),
          spin(planned.angularVelocity + planned.change.angular)
    {
    }
    /// [m/s] Bound on the speed of any vertex within the box.
    [[nodiscard]] double most(const Bounds& whole) const
    {
        Vec3 far;
        for (int i = 0; i < 3; ++i)
            far[i] = std::max(std::abs(static_cast<double>(whole.low[i]) - centre[i]),
                              std::abs(-static_cast<double>(whole.negatedHigh[i]) - centre[i]));
        return length(velocity) + length(spin) * length(far);
    }
    /// [m/s] The mean velocity of a place: turned exactly, as a body may turn by half a radian in a step.
    [[nodiscard]] Vec3 at(Vec3 place, double dt) const
    {
        const double angle = dt * length(spin);
        const Vec3 arm = place - centre;
        if (!(angle > 0.0)) return velocity;
        return velocity + 1.0 / dt * (rotate(axisAngle(spin, angle), arm) - arm);
    }
};

class RigidPasses {
public:
    RigidPasses(const StepContext& context, const Scene& scene, Coupling& coupling)
        : context_(context), scene_(scene), coupling_(coupling), owners_(surfaceOwners(scene))
    {
    }

    std::vector<MissedContact> run()
    {
        std::vector<MissedContact> out;
        for (std::size_t line = 0; line < owners_.size(); ++line)
            if (isLine(scene_, owners_[line])) findAround(line, out);
        return out;
    }

private:
    [[nodiscard]] CollisionSurface& surface(std::size_t i) { return coupling_.detection.surfaces[i]; }

    void findAround(std::size_t line, std::vector<MissedContact>& out)
    {
        const SoftBody& rod = scene_.soft[owners_[line].body];
        std::vector<Vec3> solved = rod.state.v;
        double fastest = 0.0;
        for (std::size_t n = 0; n < solved.size(); ++n) {
            solved[n] += rod.system.dv[n];
            fastest = std::max(fastest, length(solved[n]));
        }
        if (!usable(solved)) return;
        solved.swap(surface(line).v);
        for (std::size_t other = 0; other < owners_.size(); ++other)
            if (!owners_[other].soft && surface(other).shape->triangleFaces &&
                mayCollide(surface(line), surface(other)))
                findBetween(line, other, fastest, out);
        solved.swap(surface(line).v);
    }

    void findBetween(std::size_t line, std::size_t other, double fastest, std::vector<MissedContact>& out)
    {
        CollisionSurface &rod = surface(line), &body = surface(other);
        const SolvedMotion motion(coupling_.rigid[owners_[other].plan]);
        const double moves = context_.dt * (fastest + motion.most(body.whole));
        if (!(moves > kSlow * scene_.soft[owners_[line].body].model.rod.radius) || !std::isfinite(moves)) return;
        std::vector<Vec3> solved;
        for (const Vec3 x : body.x) solved.push_back(motion.at(x, context_.dt));
        solved.swap(body.v);
        const std::array<int, 2> places{static_cast<int>(line), static_cast<int>(other)};
        for (const Proximity& pass :
             findSurfacePasses(context_.dt, rod, body, places, coupling_.detection.scratch, context_.pool))
            add(pass, line, other, out);
        solved.swap(body.v);
    }

    void add(const Proximity& pass, std::size_t line, std::size_t other, std::vector<MissedContact>& out)
    {
        const std::array<int, 2> places{static_cast<int>(line), static_cast<int>(other)};
        if (isHeldBy(scene_, {owners_[line], pass.vertices[0]}, owners_[other].name.body)) return;
        const FeatureCorners one = corners(pass, 0, places), two = corners(pass, 1, places);
        const bool edges = two.vertices[2] < 0;
        const Vec3 between = edges
                                 ? betweenEdges({one.x[0], one.x[1]}, {two.x[0], two.x[1]})
                                 : one.x[0] - geometry::nearestOnTriangle(one.x[0], two.x[0], two.x[1], two.x[2]).point;
        const Vec3 outwards = featureNormal(surface(other), two.vertices);
        if (surface(other).shape->closed && dot(between, outwards) < 0.0) return; // it comes out
        const auto insetOf = [&](std::size_t owner, int vertex) {
            return owners_[owner].collision->inset.depth[static_cast<std::size_t>(vertex)];
        };
        const std::size_t body = owners_[line].body;
        addPlane(one, two, between, normalized(outwards, {0, 0, 1}),
                 insetOf(line, one.vertices[0]) + insetOf(other, two.vertices[0]), {body, body}, out);
    }

    [[nodiscard]] FeatureCorners corners(const Proximity& pass, std::size_t side, const std::array<int, 2>& places)
    {
        FeatureCorners out{places[side], pass.vertices[side]};
        for (std::size_t k = 0; k < 3; ++k)
            if (const int vertex = out.vertices[k]; vertex >= 0)
                out.x[k] = surface(static_cast<std::size_t>(places[side])).x[static_cast<std::size_t>(vertex)];
        return out;
    }

    const StepContext& context_;
    const Scene& scene_;
    Coupling& coupling_;
    std::vector<SurfaceOwner> owners_;
};

} // namespace

std::vector<MissedContact> findRigidPasses(const StepContext& context, const Scene& scene, Coupling& coupling)
{
    return RigidPasses(context, scene, coupling).run();
}

void carryAlong(double dt, std::span<const MissedContact> passes, const Coupling& coupling, Scene& scene)
{
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    for (const MissedContact& each : passes) {
        SoftBody& rod = scene.soft[each.bodies[0]];
        const auto node = static_cast<std::size_t>(each.at.vertices[0][0]);
        const SolvedMotion motion(coupling.rigid[owners[static_cast<std::size_t>(each.at.surfaces[1])].plan]);
        if (!rod.model.pins.hard[node]) rod.system.dv[node] = motion.at(rod.state.x[node], dt) - rod.state.v[node];
    }
}

} // namespace filasofia::engine
