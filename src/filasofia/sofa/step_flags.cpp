#include "filasofia/sofa/step_flags.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/math/svd.h"
#include "filasofia/sofa/tear_stress.h"

#include <algorithm>
#include <cmath>

namespace filasofia::sofaengine {
namespace {

using physics::BodyMotion;

void invertedIn(const SoftNode& body, const std::vector<Vec3>& positions, physics::InvertedElements& report)
{
    const geometry::TetMesh& mesh = body.plan().mesh;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const double volume = engine::volumeOf(engine::cornersOf(mesh.tetrahedra[t], positions));
        if (volume > 0.0 || body.isHeld(mesh.tetrahedra[t])) continue;
        const double part = volume / signedVolume(mesh, static_cast<int>(t));
        ++report.count;
        if (!report.body || part < report.volume)
            report = {report.count, body.id(), static_cast<int>(t), part,
                      engine::middleOf(mesh.tetrahedra[t], positions)};
    }
}

double strainOf(const Mat3& gradient)
{
    const Vec3 stretches = svd(gradient).sigma;
    return std::max({std::abs(stretches.x - 1.0), std::abs(stretches.y - 1.0), std::abs(stretches.z - 1.0)});
}

void strainedIn(const SoftNode& body, const std::vector<Vec3>& positions, physics::StrainedElements& report)
{
    const auto* tissue = std::get_if<physics::FemMaterial>(&body.plan().def.material);
    if (!tissue || !std::isfinite(tissue->validStrain)) return;
    const double valid = tissue->validStrain;
    const geometry::TetMesh& mesh = body.plan().mesh;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (body.isHeld(mesh.tetrahedra[t])) continue;
        const double strain = strainOf(gradientOf(body.plan(), t, positions));
        if (!(strain > valid)) continue;
        ++report.count;
        if (!report.body || strain / valid > report.strain / report.valid)
            report = {report.count, body.id(), static_cast<int>(t),
                      strain,       valid,     engine::middleOf(mesh.tetrahedra[t], positions)};
    }
}

/// Energies of a body of points.
BodyMotion motionOf(const SoftNode& body, Vec3 gravity)
{
    SoftState now;
    body.read(now);
    BodyMotion out{.body = body.id(), .speed = body.speed()};
    for (std::size_t i = 0; i < now.velocities.size(); ++i) {
        const double mass = body.plan().masses[i];
        out.kinetic += 0.5 * mass * lengthSquared(now.velocities[i]);
        if (body.plan().def.gravity) out.potential -= mass * dot(gravity, now.positions[i]);
    }
    return out;
}

BodyMotion motionOf(const RigidNode& body, Vec3 gravity)
{
    RigidState now;
    body.read(now);
    BodyMotion out{.body = body.id()};
    for (std::size_t e = 0; e < now.poses.size(); ++e)
        addElement(body.plan().links.empty() ? body.plan().inertia : body.plan().links[e], now.poses[e],
                   now.velocities[e], now.angularVelocities[e], body.plan().def.gravity ? gravity : Vec3{}, out);
    return out;
}

/// A hash of what drives the bodies: gravity, forces and pressures, told poses and joints, hands.
std::uint64_t hashOfDrive(const SofaScene& scene)
{
    Hasher hash;
    const Vec3 gravity = fromSofa(scene.root->getGravity());
    hash.addAll(std::span<const Vec3>(&gravity, 1));
    for (const auto& body : scene.soft) {
        for (const physics::NodalForce& each : body->loads().forces) {
            hash.add(static_cast<std::uint64_t>(each.node));
            hash.addAll(std::span<const Vec3>(&each.force, 1));
        }
        hash.add(body->loads().pressure);
    }
    for (const auto& body : scene.rigid) {
        addTo(hash, body->settings(), true);
        if (body->plan().def.dynamic) continue;
        RigidState now;
        body->read(now);
        const bool jointed = !body->joints().empty(); // what moves its links is above
        hash.addAll(std::span<const Pose>(now.poses).first(jointed ? 1 : now.poses.size()));
    }
    return hash.value();
}

} // namespace

void findInverted(const SofaScene& scene, const SceneMotion& at, physics::StepReport& report)
{
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        invertedIn(*scene.soft[b], at.soft[b].positions, report.inverted);
    if (report.inverted.count > 0) report.set(physics::StepFlag::Inverted);
}

void findStrained(const SofaScene& scene, const SceneMotion& at, physics::StepReport& report)
{
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        strainedIn(*scene.soft[b], at.soft[b].positions, report.beyondStrain);
    if (report.beyondStrain.count > 0) report.set(physics::StepFlag::BeyondStrain);
}

void SceneWatch::follow(bool changes, double dt, const SofaScene& scene, physics::StepReport& report)
{
    const std::uint64_t drive = hashOfDrive(scene);
    const bool driven = std::exchange(drive_, drive) != drive || changes || !report.topology.ruptures.empty();
    const auto motions = [&] {
        const Vec3 gravity = fromSofa(scene.root->getGravity());
        std::vector<BodyMotion> all;
        for (const auto& each : scene.soft) all.push_back(motionOf(*each, gravity));
        for (const auto& each : scene.rigid)
            if (each->plan().def.dynamic) all.push_back(motionOf(*each, gravity));
        return all;
    };
    watch_.follow(driven, dt, motions, report);
}

} // namespace filasofia::sofaengine
