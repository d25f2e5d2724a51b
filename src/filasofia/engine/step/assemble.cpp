#include "filasofia/engine/step/assemble.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/law_range.h"
#include "filasofia/engine/scene/each_body.h"
#include "filasofia/engine/step/fill_cavities.h"
#include "filasofia/math/svd.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

/// Computes the forces other than elasticity and damping: weight, the user's forces, pin springs, pressure on the
/// surface.
void addExternalForces(const SoftModel& model, const Assembly& how, const SoftState& state, std::vector<Vec3>& forces)
{
    const Vec3 gravity = how.gravity;
    for (std::size_t i = 0; i < forces.size(); ++i)
        forces[i] = state.forces[i] + (model.gravity ? model.masses[i] * gravity : Vec3{});
    for (const ReducedForce& each : how.reduced)
        for (const int node : model.pieces[each.piece].nodes) forces[node] -= (1.0 - each.part) * state.forces[node];
    if (model.gravity) // the weight of a liquid is in its pressure
        for (std::size_t i = 0; i < model.filling.size(); ++i) forces[i] = forces[i] - model.filling[i] * gravity;
    addPinForces(model.pins, state.x, forces);
    if (state.pressure == 0.0 || model.leaks) return;
    for (std::size_t i = 0; i < model.surface.size(); ++i) {
        if (!isShell(model) && !model.wallOf.empty() && model.wallOf[i] >= 0) continue; // inside
        const geometry::Triangle& t = model.surface[i];
        const Vec3 area = areaOf(t, state.x); // outwards
        for (int node : t) forces[node] -= state.pressure / 3.0 * area;
    }
}

/// Calls look(element) for the elements of a body that its system has marked as inverted; for all if that marks none.
template <class Look> void forEachMarked(const SoftBody& body, const Look& look)
{
    const std::size_t count = body.model.elements.size();
    if (!body.system.matrixFree) {
        for (std::size_t e = 0; e < count; ++e) look(e);
        return;
    }
    const std::span<const std::uint16_t> bits = body.system.matrixFree->inverted();
    for (std::size_t block = 0; block < bits.size(); ++block)
        for (std::size_t lane = 0; lane < kBlock && bits[block] != 0; ++lane)
            if (const std::size_t e = kBlock * block + lane; (bits[block] >> lane & 1u) != 0 && e < count) look(e);
}

Vec3 middle(const Corners& x) { return 0.25 * (x[0] + x[1] + x[2] + x[3]); }

void addInverted(const SoftModel& model, int element, double volume, Vec3 place, physics::InvertedElements& report)
{
    ++report.count;
    if (volume < report.volume) report = {report.count, model.id, element, volume, place};
}

/// Reports the inverted elements of a body. Those of which every node is fixed, for example in a removed piece, are
/// left out: nothing will ever change them.
void findInverted(const SoftBody& body, physics::InvertedElements& report)
{
    const SoftModel& model = body.model;
    forEachMarked(body, [&](std::size_t e) {
        const Corners corners = cornersOf(model.elements[e].nodes, body.state.x);
        const double volume = determinant(gradient(model.elements[e], corners));
        if (volume > 0.0 || allHeld(model, e)) return;
        addInverted(model, model.elements[e].tetrahedron, volume, middle(corners), report);
    });
    for (std::size_t e = 0; e < model.tetrahedra.size(); ++e) { // springs do not resist it
        const Corners corners = cornersOf(model.tetrahedra[e], body.state.x);
        const double volume = volumeOf(corners);
        if (volume > 0.0 || allHeld(model, e)) continue;
        const double atRest = volumeOf(cornersOf(model.tetrahedra[e], model.rest));
        addInverted(model, static_cast<int>(e), volume / atRest, middle(corners), report);
    }
}

/// [-] By how much a principal stretch of an element differs from 1 at most.
double strainOf(const SoftBody& body, std::size_t e)
{
    const FemElement& element = body.model.elements[e];
    const Vec3 stretches = svd(gradient(element, cornersOf(element.nodes, body.state.x))).sigma;
    return std::max({std::abs(stretches.x - 1.0), std::abs(stretches.y - 1.0), std::abs(stretches.z - 1.0)});
}

/// A strain and the range of its material.
struct RangedStrain {
    double strain = 0.0, valid = 0.0;
};
bool isWorse(RangedStrain a, RangedStrain b) { return a.strain / a.valid > b.strain / b.valid; }
bool isWorse(RangedStrain a, const physics::StrainedElements& report)
{
    return !report.body || isWorse(a, RangedStrain{report.strain, report.valid});
}

/// How much the elements of a body are strained, by their principal stretches and by the mean stretch that the law
/// limits (physics::rangeOf).
class ElementStrains {
public:
    explicit ElementStrains(const SoftBody& body)
        : body_(body), valid_(body.model.material.validStrain), safe_(safeStrain(body.model.material.law)),
          cube_(std::pow(3.0 + physics::rangeOf(body.model.material.law), 3.0))
    {
    }
    [[nodiscard]] bool haveRange() const { return std::isfinite(valid_) || std::isfinite(cube_); }

    /// [-] The strain over the range. The solver has found the principal stretches in float.
    [[nodiscard]] double share(std::size_t e) const
    {
        const MatrixFreeSystem* system = body_.system.matrixFree.get();
        const double strain = system ? static_cast<double>(system->strains()[e]) : strainOf(body_, e);
        const double out = strain / valid_;
        if (!(strain > safe_)) return out;
        const double cube = cubeOf(e);
        return cube > cube_ ? std::max(out, meanStrain(cube) / meanStrain(cube_)) : out;
    }
    [[nodiscard]] RangedStrain worse(std::size_t e) const
    {
        const RangedStrain principal{strainOf(body_, e), valid_}, mean{meanStrain(cubeOf(e)), meanStrain(cube_)};
        return isWorse(mean, principal) ? mean : principal;
    }

private:
    [[nodiscard]] double cubeOf(std::size_t e) const
    {
        const FemElement& element = body_.model.elements[e];
        return cubedInvariantOf(element, cornersOf(element.nodes, body_.state.x));
    }
    /// sqrt(i1 / 3) - 1
    static double meanStrain(double cube) { return std::sqrt(std::cbrt(cube) / 3.0) - 1.0; }

    const SoftBody& body_;
    double valid_, safe_, cube_; ///< [-] the most of strainOf(), what is safe for cubeOf(), and the most of that
};

/// Reports the elements that are strained beyond the range of their material. The worst is that of the largest strain
/// in relation to its range.
void findStrained(const SoftBody& body, physics::StrainedElements& report)
{
    const SoftModel& model = body.model;
    const ElementStrains strains(body);
    if (!strains.haveRange()) return;
    std::size_t worst = model.elements.size();
    double most = 1.0;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const double share = strains.share(e);
        if (!(share > 1.0) || allHeld(model, e)) continue;
        ++report.count;
        if (share > most) most = share, worst = e;
    }
    if (worst == model.elements.size()) return;
    const RangedStrain found = strains.worse(worst);
    if (!isWorse(found, report)) return;
    const FemElement& element = model.elements[worst];
    report = {report.count, model.id,    element.tetrahedron,
              found.strain, found.valid, middle(cornersOf(element.nodes, body.state.x))};
}

/// The same for the triangles of a shell.
void findStrainedTriangles(const SoftBody& body, physics::StrainedElements& report)
{
    const Shell& shell = body.model.shell;
    const double valid = shell.material.validStrain;
    if (!(valid < std::numeric_limits<double>::infinity())) return;
    const auto fixed = [&](int node) { return body.model.pins.hard[static_cast<std::size_t>(node)]; };
    for (const MembraneElement& each : shell.membranes) {
        const double strain = strainOf(each, body.state.x);
        if (!(strain > valid) || std::ranges::all_of(each.nodes, fixed)) continue;
        ++report.count;
        if (!isWorse(RangedStrain{strain, valid}, report)) continue;
        const TriangleCorners x = vectorsAt(each.nodes, body.state.x);
        report = {report.count, body.model.id, each.triangle, strain, valid, 1.0 / 3.0 * (x[0] + x[1] + x[2])};
    }
}

} // namespace

void assembleBody(const Assembly& how, SoftBody& body, WorkerPool& pool)
{
    SoftSystem& system = body.system;
    addExternalForces(body.model, how, body.state, system.forces);
    addCavityForces({how.gravity, how.dt}, body.model, body.state, system.forces, system.cavities);
    if (system.rod)
        system.rod->assemble(body.model, system.forces, how.dt, how.inertia, body.state);
    else if (system.matrixFree) {
        system.matrixFree->setCavities(system.cavities);
        system.matrixFree->assemble(body.model, system.forces, how.dt, how.inertia, body.state, pool);
        if (!system.held.holders.empty()) system.matrixFree->keepHeld(body.model, system.held);
    } else
        assembleMatrix(body.model, system.forces, how.dt, how.inertia, body.state, *system.assembled);
}

void assemble(const StepContext& context, Scene& scene)
{
    if (context.dt == 0.0) return;
    forEachBody(scene, context.pool, [&](SoftBody& body, std::size_t) {
        assembleBody({scene.gravity, context.dt, 1.0, reducedForces(context.dt, body, scene)}, body, context.pool);
    });
    physics::StepReport& report = context.report;
    for (const SoftBody& body : scene.soft) {
        findInverted(body, report.inverted);
        findStrained(body, report.beyondStrain);
        findStrainedTriangles(body, report.beyondStrain);
    }
    if (report.inverted.count > 0) report.set(physics::StepFlag::Inverted);
    if (report.beyondStrain.count > 0) report.set(physics::StepFlag::BeyondStrain);
}

} // namespace filasofia::engine
