#include "filasofia/engine/contact/solve_island.h"

#include "filasofia/engine/rigid/articulation_operator.h"
#include "filasofia/engine/constraint/block_operator.h"
#include "filasofia/engine/soft/matrix_free_operator.h"

#include <algorithm>
#include <memory>

namespace filasofia::engine {
namespace {

/// What one body brings into the solve, and what that is made from.
struct Unit {
    CoupledBody* share = nullptr;
    std::unique_ptr<PlainShare> plain;
    std::unique_ptr<ArticulatedShare> articulated;
    std::vector<Mat3> diagonal;
    std::vector<Vec3> rightHandSide;
};

bool isImplicit(const SoftModel& model) { return std::holds_alternative<physics::ImplicitEuler>(model.integrator); }

/// [kg] of what moves.
double massOf(const SoftModel& model)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < model.masses.size(); ++i) sum += model.pins.hard[i] ? 0.0 : model.masses[i];
    return sum;
}

/// A body whose matrix is its masses: what it would do alone is known, and tells the right-hand side.
void makeExplicit(const SoftModel& model, double dt, const SoftState& state, SoftSystem& system, Unit& unit)
{
    if (system.matrixFree)
        system.matrixFree->solveExplicit(system.dv);
    else
        solve(model, dt, 1.0, state.v, *system.assembled, system.dv);
    for (std::size_t i = 0; i < model.masses.size(); ++i) {
        unit.diagonal.push_back(model.masses[i] * Mat3::identity());
        unit.rightHandSide.push_back(model.pins.hard[i] ? Vec3{} : model.masses[i] * system.dv[i]);
    }
    unit.plain = std::make_unique<PlainShare>(PlainShareInput{
        .diagonal = unit.diagonal, .rightHandSide = unit.rightHandSide, .guess = system.dv, .mass = massOf(model)});
}

/// A body with a matrix written out: a direct solver is its preconditioner, factorised once.
void makeAssembled(const SoftModel& model, double dt, const SoftState& state, SoftSystem& system, Unit& unit)
{
    AssembledSystem& assembled = *system.assembled;
    // Where it was not asked for, too: the default gives way to it where a body is nearly incompressible.
    const bool factor = assembled.solver->isDirect() && solve(model, dt, 1.0, state.v, assembled, system.dv).converged;
    unit.diagonal.resize(model.masses.size());
    assembled.matrix.diagonal(unit.diagonal);
    unit.plain = std::make_unique<PlainShare>(PlainShareInput{.diagonal = unit.diagonal,
                                                              .matrix = &assembled.matrix,
                                                              .solver = factor ? assembled.solver.get() : nullptr,
                                                              .rightHandSide = assembled.rightHandSide,
                                                              .guess = system.dv,
                                                              .mass = massOf(model)});
}

void makeSoft(const SoftModel& model, double dt, const SoftState& state, SoftSystem& system, WorkerPool& pool,
              Unit& unit)
{
    if (!isImplicit(model)) {
        makeExplicit(model, dt, state, system, unit);
    } else if (system.assembled) {
        makeAssembled(model, dt, state, system, unit);
    } else {
        if (!system.share) system.share = std::make_unique<MatrixFreeShare>(*system.matrixFree);
        system.share->prepare(system.dv, pool);
        unit.share = system.share.get();
        return;
    }
    unit.share = unit.plain.get();
}

/// Damping is implicit, and so is what a hand's coupling does: against an impulse it is as if the element were so much
/// heavier.
void makeRigid(const RigidModel& model, double dt, const RigidPlanElement& element, Unit& unit)
{
    const double mass = (1.0 + dt * model.linearDamping) * element.mass + element.heldMass;
    unit.diagonal = {mass * Mat3::identity(), (1.0 + dt * model.angularDamping) * element.inertia};
    if (element.heldInertia > 0.0) unit.diagonal[1] += element.heldInertia * Mat3::identity();
    unit.rightHandSide = {unit.diagonal[0] * element.change.linear, unit.diagonal[1] * element.change.angular};
    unit.plain = std::make_unique<PlainShare>(
        PlainShareInput{.diagonal = unit.diagonal, .rightHandSide = unit.rightHandSide, .mass = mass, .turning = true});
    unit.share = unit.plain.get();
}

void makeArticulated(const Model& model, const ArticulationPlan& articulation, const RigidPlan& plan, Unit& unit)
{
    const LinkTree& tree = model.rigidBodies[articulation.body].articulation.tree;
    std::vector<Vec3> origins;
    for (std::size_t e = 0; e < tree.jointOf.size(); ++e) origins.push_back(plan[articulation.first + e].centre);
    unit.articulated = std::make_unique<ArticulatedShare>(tree, articulation, std::move(origins));
    unit.share = unit.articulated.get();
}

/// Collects the grips of every body, and the constraints that pull at them.
class Gripping {
public:
    Gripping(const Model& model, const RigidPlan& plan, const Island& island, IslandScratch& scratch)
        : grips(island.soft.size() + island.rigid.size()), model_(model), plan_(plan), island_(island),
          gripOf_(scratch.gripOf), pieceOf_(scratch.pieceOf)
    {
    }

    std::vector<std::vector<Grip>> grips; ///< per body of the island

    void addAll(std::vector<Link>& links, Constraints& out)
    {
        out.clear();
        for (std::size_t l : island_.links) out.list.push_back(constraintOf(links[l]));
        // Body after body, so that one map of nodes serves them all.
        for (std::size_t unit = 0; unit < grips.size(); ++unit) {
            if (unit < island_.soft.size()) mapNodes(model_.softBodies[island_.soft[unit]]);
            for (std::size_t c = 0; c < out.list.size(); ++c)
                for (std::size_t side = 0; side < 2; ++side) addSide(links[island_.links[c]], side, unit, c, out);
        }
        flatten(out);
    }

private:
    struct Pull {
        std::size_t constraint, unit;
        int grip;
        double weight;
    };

    void mapNodes(const SoftModel& body)
    {
        gripOf_.assign(body.rest.size(), -1);
        pieceOf_.clear();
        if (!body.pieces.empty()) pieceOf_.assign(body.rest.size(), 0);
        for (std::size_t p = 0; p < body.pieces.size(); ++p)
            for (int node : body.pieces[p].nodes) pieceOf_[static_cast<std::size_t>(node)] = static_cast<int>(p);
    }

    static Constraint constraintOf(const Link& link)
    {
        Constraint c;
        c.point = link.sides[0].position;
        c.frame = link.frame;
        c.start = inFrame(link.frame, link.sides[0].velocity - link.sides[1].velocity);
        c.bias = link.bias;
        c.friction = link.friction;
        c.slack = link.slack;
        c.give = link.give;
        c.most = link.most;
        c.impulse = link.impulse;
        return c;
    }

    void addSide(const Link& link, std::size_t side, std::size_t unit, std::size_t constraint, Constraints& out)
    {
        const BodyPoint& point = link.sides[side];
        const double sign = side == 0 ? 1.0 : -1.0;
        const std::size_t softCount = island_.soft.size();
        if (unit < softCount && point.of == BodyPoint::Of::Soft && point.body == island_.soft[unit]) {
            const SoftModel& body = model_.softBodies[point.body];
            if (!pieceOf_.empty())
                out.list[constraint].pieces[side] = pieceOf_[static_cast<std::size_t>(point.nodes[0])];
            for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k) {
                const auto node = static_cast<std::size_t>(point.nodes[k]);
                if (body.pins.hard[node]) continue; // it does not move, whatever pulls
                int& grip = gripOf_[node];
                if (grip < 0) {
                    grip = static_cast<int>(grips[unit].size());
                    grips[unit].push_back({point.nodes[k]});
                }
                pulls_.push_back({constraint, unit, grip, sign * point.weights[k]});
            }
        } else if (unit >= softCount && planPlace(plan_, point) == island_.rigid[unit - softCount]) {
            pulls_.push_back({constraint, unit, static_cast<int>(grips[unit].size()), sign});
            if (point.of == BodyPoint::Of::Joint)
                grips[unit].push_back({0, {}, -1 - point.joint});
            else
                grips[unit].push_back(
                    {0, point.position - plan_[point.body].centre, static_cast<int>(plan_[point.body].element)});
        }
    }

    void flatten(Constraints& out)
    {
        std::vector<int> first(grips.size());
        for (std::size_t unit = 1; unit < grips.size(); ++unit)
            first[unit] = first[unit - 1] + static_cast<int>(grips[unit - 1].size());
        std::stable_sort(pulls_.begin(), pulls_.end(),
                         [](const Pull& a, const Pull& b) { return a.constraint < b.constraint; });
        for (const Pull& pull : pulls_) {
            Constraint& constraint = out.list[pull.constraint];
            if (constraint.count++ == 0) constraint.first = static_cast<int>(out.grips.size());
            out.grips.push_back({first[pull.unit] + pull.grip, pull.weight});
        }
    }

    const Model& model_;
    const RigidPlan& plan_;
    const Island& island_;
    std::vector<int>& gripOf_;
    std::vector<int>& pieceOf_;
    std::vector<Pull> pulls_;
};

} // namespace

CoupledReport solveIsland(const Model& model, const State& state, double dt, const Island& island,
                          const CoupledLimits& limits, std::vector<SoftSystem>& systems, RigidPlan& plan,
                          ArticulationPlans& articulations, std::vector<Link>& links, IslandScratch& scratch,
                          WorkerPool& pool)
{
    std::vector<Unit> units(island.soft.size() + island.rigid.size());
    std::vector<CoupledBody*> shares;
    for (std::size_t i = 0; i < units.size(); ++i) {
        if (const std::size_t r = i - island.soft.size(); i >= island.soft.size()) {
            const RigidPlanElement& element = plan[island.rigid[r]];
            if (element.articulation >= 0)
                makeArticulated(model, articulations[static_cast<std::size_t>(element.articulation)], plan, units[i]);
            else
                makeRigid(model.rigidBodies[element.body], dt, element, units[i]);
        } else
            makeSoft(model.softBodies[island.soft[i]], dt, state.softBodies[island.soft[i]], systems[island.soft[i]],
                     pool, units[i]);
        shares.push_back(units[i].share);
    }
    Gripping gripping(model, plan, island, scratch);
    gripping.addAll(links, scratch.constraints);

    const CoupledReport report = scratch.solver.solve(limits, shares, gripping.grips, scratch.constraints);

    for (std::size_t i = 0; i < island.soft.size(); ++i) {
        SoftSystem& system = systems[island.soft[i]];
        if (!units[i].plain)
            system.matrixFree->finish(report, system.dv, system.leftover, pool);
        else
            std::ranges::copy(units[i].plain->answer(), system.dv.begin());
    }
    for (std::size_t i = 0; i < island.rigid.size(); ++i) {
        const Unit& unit = units[island.soft.size() + i];
        RigidPlanElement& element = plan[island.rigid[i]];
        if (unit.articulated) {
            setChange(model, unit.articulated->answer(), articulations[static_cast<std::size_t>(element.articulation)],
                      plan);
        } else {
            const std::span<const Vec3> change = unit.plain->answer();
            element.change = {change[0], change[1]};
        }
    }
    for (std::size_t c = 0; c < island.links.size(); ++c) {
        const auto finite = [](Vec3 impulse) { return isFinite(impulse) ? impulse : Vec3{}; };
        links[island.links[c]].impulse = finite(scratch.constraints.list[c].impulse);
        links[island.links[c]].next = finite(scratch.constraints.list[c].next);
    }
    return report;
}

} // namespace filasofia::engine
