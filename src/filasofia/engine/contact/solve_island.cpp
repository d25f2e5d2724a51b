#include "filasofia/engine/contact/solve_island.h"

#include "filasofia/engine/constraint/block_operator.h"
#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/rigid/articulation_operator.h"
#include "filasofia/engine/soft/matrix_free_operator.h"
#include "filasofia/engine/soft/rod_operator.h"

#include <algorithm>
#include <memory>

namespace filasofia::engine {
namespace {

/// One body's operator in the solve, and the data that it is built on.
struct Unit {
    CoupledBody body;
    std::unique_ptr<BlockOperator> blocks;
    std::unique_ptr<ArticulationOperator> articulated;
    std::unique_ptr<RodOperator> rod;
    std::vector<Mat3> diagonal;
    std::vector<Vec3> rightHandSide;
};

bool isImplicit(const SoftModel& model) { return std::holds_alternative<physics::ImplicitEuler>(model.integrator); }

/// Mass of the free nodes [kg].
double massOf(const SoftModel& model)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < model.masses.size(); ++i) sum += model.pins.hard[i] ? 0.0 : model.masses[i];
    return sum;
}

/// An explicit body's matrix is its masses. Its unconstrained change is known, and gives the right-hand side.
void makeExplicit(double dt, SoftBody& body, Unit& unit)
{
    const SoftModel& model = body.model;
    const SoftState& state = body.state;
    SoftSystem& system = body.system;
    if (system.matrixFree)
        system.matrixFree->solveExplicit(system.dv);
    else
        solve(model, dt, 1.0, state.v, *system.assembled, system.dv);
    for (std::size_t i = 0; i < model.masses.size(); ++i) {
        unit.diagonal.push_back(model.masses[i] * Mat3::identity());
        unit.rightHandSide.push_back(model.pins.hard[i] ? Vec3{} : model.masses[i] * system.dv[i]);
    }
    unit.blocks = std::make_unique<BlockOperator>(BlockOperatorInput{
        .diagonal = unit.diagonal, .rightHandSide = unit.rightHandSide, .guess = system.dv, .mass = massOf(model)});
}

/// A body with an assembled matrix. If it has a direct solver, this is its preconditioner, factorised once.
void makeAssembled(double dt, SoftBody& body, Unit& unit)
{
    const SoftModel& model = body.model;
    const SoftState& state = body.state;
    SoftSystem& system = body.system;
    AssembledSystem& assembled = *system.assembled;
    // A direct solver may be there without being requested: the default falls back to it if a body is nearly
    // incompressible.
    const bool factor = assembled.solver->isDirect() && solve(model, dt, 1.0, state.v, assembled, system.dv).converged;
    unit.diagonal.resize(model.masses.size());
    assembled.matrix.diagonal(unit.diagonal);
    unit.blocks =
        std::make_unique<BlockOperator>(BlockOperatorInput{.diagonal = unit.diagonal,
                                                           .matrix = &assembled.matrix,
                                                           .solver = factor ? assembled.solver.get() : nullptr,
                                                           .rightHandSide = assembled.rightHandSide,
                                                           .guess = system.dv,
                                                           .mass = massOf(model)});
}

void makeSoft(double dt, SoftBody& body, WorkerPool& pool, Unit& unit)
{
    SoftSystem& system = body.system;
    if (system.rod) {
        unit.rod = std::make_unique<RodOperator>(*system.rod, system.dv, massOf(body.model));
        unit.body = coupled(*unit.rod);
        return;
    }
    if (!isImplicit(body.model)) {
        makeExplicit(dt, body, unit);
    } else if (system.assembled) {
        makeAssembled(dt, body, unit);
    } else {
        if (!system.coupled) system.coupled = std::make_unique<MatrixFreeOperator>(*system.matrixFree);
        system.coupled->prepare(system.dv, pool);
        unit.body = coupled(*system.coupled);
        return;
    }
    unit.body = coupled(*unit.blocks);
}

/// Damping is implicit, and so is a virtual coupling: to an impulse, both make the element heavier.
void makeRigid(const RigidModel& model, double dt, const RigidPlanElement& element, Unit& unit)
{
    const double mass = (1.0 + dt * model.linearDamping) * element.mass + element.couplingMass;
    unit.diagonal = {mass * Mat3::identity(), (1.0 + dt * model.angularDamping) * element.inertia};
    unit.diagonal[1] += element.heldInertia;
    if (element.couplingInertia > 0.0) unit.diagonal[1] += element.couplingInertia * Mat3::identity();
    unit.rightHandSide = {unit.diagonal[0] * element.change.linear, unit.diagonal[1] * element.change.angular};
    unit.blocks = std::make_unique<BlockOperator>(BlockOperatorInput{
        .diagonal = unit.diagonal, .rightHandSide = unit.rightHandSide, .mass = mass, .turning = true});
    unit.body = coupled(*unit.blocks);
}

void makeArticulated(const LinkTree& tree, const ArticulationPlan& articulation, const RigidPlan& plan, Unit& unit)
{
    std::vector<Vec3> origins;
    for (std::size_t e = 0; e < tree.jointOf.size(); ++e) origins.push_back(plan[articulation.first + e].centre);
    unit.articulated = std::make_unique<ArticulationOperator>(tree, articulation, std::move(origins));
    unit.body = coupled(*unit.articulated);
}

/// Collects the contact points of every body, and the rows of J over them.
class RowBuilder {
public:
    RowBuilder(const Island& island, const Scene& scene, Coupling& coupling)
        : points(island.soft.size() + island.rigid.size()), scene_(scene), island_(island), coupling_(coupling),
          pointOf_(coupling.scratch.pointOf), pieceOf_(coupling.scratch.pieceOf), placeOf_(coupling.scratch.placeOf)
    {
    }

    std::vector<std::vector<ContactPoint>> points; ///< per body of the island

    void addAll(ConstraintRows& out)
    {
        out.clear();
        for (std::size_t c : island_.constraints) out.list.push_back({.constraint = &coupling_.constraints[c]});
        findSides(out);
        // Goes through one body after another, so that one map of nodes serves all.
        std::size_t next = 0;
        for (std::size_t unit = 0; unit < points.size(); ++unit) {
            if (unit < island_.soft.size()) mapNodes(scene_.soft[island_.soft[unit]].model);
            for (; next < sides_.size() && sides_[next].unit == unit; ++next) addSide(sides_[next], out);
        }
        flatten(out);
    }

private:
    /// A side of a constraint that moves with a body of the island.
    struct Side {
        std::size_t unit, row, side;
    };
    /// A weight of J: constraint row, body, contact point of the body.
    struct Entry {
        std::size_t row, unit;
        int point;
        double weight;
    };

    void mapNodes(const SoftModel& body)
    {
        pointOf_.assign(body.rest.size(), -1);
        pieceOf_.clear();
        if (!body.pieces.empty()) pieceOf_.assign(body.rest.size(), 0);
        for (std::size_t p = 0; p < body.pieces.size(); ++p)
            for (int node : body.pieces[p].nodes) pieceOf_[static_cast<std::size_t>(node)] = static_cast<int>(p);
    }

    /// Body by body, in the order of the rows.
    void findSides(const ConstraintRows& rows)
    {
        const std::size_t soft = scene_.soft.size();
        placeOf_.resize(soft + coupling_.rigid.size());
        for (std::size_t k = 0; k < island_.soft.size(); ++k) placeOf_[island_.soft[k]] = k;
        for (std::size_t k = 0; k < island_.rigid.size(); ++k)
            placeOf_[soft + island_.rigid[k]] = island_.soft.size() + k;
        for (std::size_t row = 0; row < rows.list.size(); ++row)
            for (std::size_t side = 0; side < 2; ++side)
                if (const auto unit = unitOf(soft, coupling_.rigid, rows.list[row].constraint->sides[side]))
                    sides_.push_back({placeOf_[*unit], row, side});
        std::ranges::stable_sort(sides_, {}, &Side::unit);
    }

    void addSide(const Side& of, ConstraintRows& out)
    {
        const BodyPoint& at = out.list[of.row].constraint->sides[of.side];
        const double sign = of.side == 0 ? 1.0 : -1.0;
        const auto add = [&](const ContactPoint& point) {
            entries_.push_back({of.row, of.unit, static_cast<int>(points[of.unit].size()), sign});
            points[of.unit].push_back(point);
        };
        if (at.of == BodyPoint::Of::Soft) {
            addNodes(of, sign, out);
            for (std::size_t k = 0; k < 2 && at.edges[k] >= 0; ++k)
                if (!clamped(scene_.soft[at.body].model.pins.hard, static_cast<std::size_t>(at.edges[k])))
                    add({.node = at.edges[k], .perSpin = at.perSpin[k]});
        } else if (at.of == BodyPoint::Of::RodEdge) {
            if (!clamped(scene_.soft[at.body].model.pins.hard, static_cast<std::size_t>(at.edge)))
                add({.node = at.edge, .perSpin = Vec3{length(at.axis), 0.0, 0.0}});
        } else if (at.of == BodyPoint::Of::Joint) {
            add({.joint = at.joint});
        } else {
            const int link = static_cast<int>(coupling_.rigid[at.body].element);
            if (at.of == BodyPoint::Of::Turning)
                add({.link = link, .axis = at.axis});
            else
                add({.arm = at.position + at.shift - coupling_.rigid[at.body].centre, .link = link});
        }
    }

    void addNodes(const Side& of, double sign, ConstraintRows& out)
    {
        const auto [unit, row, side] = of;
        const BodyPoint& at = out.list[row].constraint->sides[side];
        const SoftModel& body = scene_.soft[at.body].model;
        if (!pieceOf_.empty()) out.list[row].pieces[side] = pieceOf_[static_cast<std::size_t>(at.nodes[0])];
        for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k) {
            const auto node = static_cast<std::size_t>(at.nodes[k]);
            if (body.pins.hard[node]) continue; // it does not move, whatever pulls at it
            int& point = pointOf_[node];
            if (point < 0) {
                point = static_cast<int>(points[unit].size());
                points[unit].push_back({.node = at.nodes[k]});
            }
            entries_.push_back({row, unit, point, sign * at.weights[k]});
        }
    }

    void flatten(ConstraintRows& out)
    {
        std::vector<int> first(points.size());
        for (std::size_t unit = 1; unit < points.size(); ++unit)
            first[unit] = first[unit - 1] + static_cast<int>(points[unit - 1].size());
        std::ranges::stable_sort(entries_, {}, &Entry::row);
        for (const Entry& entry : entries_) {
            ConstraintRow& row = out.list[entry.row];
            if (row.count++ == 0) row.first = static_cast<int>(out.points.size());
            out.points.push_back({first[entry.unit] + entry.point, entry.weight});
        }
    }

    const Scene& scene_;
    const Island& island_;
    Coupling& coupling_;
    std::vector<int>& pointOf_;
    std::vector<int>& pieceOf_;
    std::vector<std::size_t>& placeOf_;
    std::vector<Side> sides_;
    std::vector<Entry> entries_;
};

std::vector<Unit> makeUnits(const StepContext& context, const Island& island, Scene& scene, const Coupling& coupling)
{
    std::vector<Unit> units(island.soft.size() + island.rigid.size());
    for (std::size_t i = 0; i < island.soft.size(); ++i)
        makeSoft(context.dt, scene.soft[island.soft[i]], context.pool, units[i]);
    for (std::size_t i = 0; i < island.rigid.size(); ++i) {
        Unit& unit = units[island.soft.size() + i];
        const RigidPlanElement& element = coupling.rigid[island.rigid[i]];
        const RigidModel& model = scene.rigid[element.body].model;
        if (element.articulation >= 0)
            makeArticulated(model.articulation.tree,
                            coupling.articulations[static_cast<std::size_t>(element.articulation)], coupling.rigid,
                            unit);
        else
            makeRigid(model, context.dt, element, unit);
    }
    return units;
}

/// What is known of the attachments between soft bodies of the island.
std::vector<SolvedTie> tiesOf(const Island& island, const Scene& scene)
{
    std::vector<SolvedTie> ties;
    for (const TiedBodies& each : scene.ties.groups) {
        SolvedTie tie{each.coarse.get(), {}};
        for (std::size_t i = 0; i < island.soft.size(); ++i)
            if (std::ranges::count(each.bodies, scene.soft[island.soft[i]].model.id) > 0) tie.bodies.push_back(i);
        if (tie.bodies.size() == each.bodies.size()) ties.push_back(std::move(tie));
    }
    return ties;
}

/// Stores the solution in the bodies.
void storeSolution(const std::vector<Unit>& units, const CoupledReport& report, const Island& island, WorkerPool& pool,
                   Scene& scene, Coupling& coupling)
{
    for (std::size_t i = 0; i < island.soft.size(); ++i) {
        SoftSystem& system = scene.soft[island.soft[i]].system;
        if (units[i].rod)
            system.rod->take(units[i].rod->answer(), system.dv);
        else if (!units[i].blocks)
            system.matrixFree->finish(report, system.dv, system.residual, pool);
        else
            std::ranges::copy(units[i].blocks->answer(), system.dv.begin());
    }
    for (std::size_t i = 0; i < island.rigid.size(); ++i) {
        const Unit& unit = units[island.soft.size() + i];
        RigidPlanElement& element = coupling.rigid[island.rigid[i]];
        if (unit.articulated) {
            setChange(scene.rigid[element.body].model.articulation.tree, unit.articulated->answer(),
                      coupling.articulations[static_cast<std::size_t>(element.articulation)], coupling.rigid);
        } else {
            const std::span<const Vec3> change = unit.blocks->answer();
            element.change = {change[0], change[1]};
        }
    }
}

} // namespace

CoupledReport solveIsland(const StepContext& context, const Island& island, const CoupledLimits& limits, Scene& scene,
                          Coupling& coupling)
{
    const std::vector<Unit> units = makeUnits(context, island, scene, coupling);
    std::vector<CoupledBody> bodies;
    for (const Unit& unit : units) bodies.push_back(unit.body);
    RowBuilder builder(island, scene, coupling);
    builder.addAll(coupling.scratch.rows);

    const CoupledReport report =
        coupling.scratch.solver.solve(limits, bodies, builder.points, coupling.scratch.rows, tiesOf(island, scene));

    storeSolution(units, report, island, context.pool, scene, coupling);
    for (std::size_t c : island.constraints) {
        Constraint& constraint = coupling.constraints[c];
        for (Vec3* each : {&constraint.impulse, &constraint.multiplier})
            if (!isFinite(*each)) *each = {};
    }
    return report;
}

} // namespace filasofia::engine
