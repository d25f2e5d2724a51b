#include "filasofia/sofa/soft_node.h"

#include "filasofia/core/error.h"
#include "filasofia/sofa/collision_node.h"
#include "filasofia/sofa/compliant_factor.h"
#include "filasofia/sofa/free_correction.h"
#include "filasofia/sofa/node_removal.h"
#include "filasofia/sofa/soft_law.h"

#include "filasofia/physics/rigid_body_def.h"

#include <sofa/component/constraint/lagrangian/correction/LinearSolverConstraintCorrection.h>
#include <sofa/component/constraint/projective/FixedProjectiveConstraint.h>
#include <sofa/component/linearsolver/iterative/CGLinearSolver.h>
#include <sofa/component/linearsystem/MatrixLinearSystem.h>
#include <sofa/component/mass/DiagonalMass.h>
#include <sofa/component/odesolver/backward/EulerImplicitSolver.h>
#include <sofa/component/odesolver/forward/EulerExplicitSolver.h>
#include <sofa/component/topology/container/dynamic/TetrahedronSetTopologyContainer.h>
#include <sofa/simulation/Simulation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::sofaengine {
namespace {

using namespace ::sofa::component;
using ::sofa::core::objectmodel::New;
using Fixed = constraint::projective::FixedProjectiveConstraint<Vec3Types>;
using Scattered = linearsolver::GraphScatteredMatrix;
using FreeGradients = linearsolver::iterative::CGLinearSolver<Scattered, linearsolver::GraphScatteredVector>;
using AssembledGradients = linearsolver::iterative::CGLinearSolver<Blocks, Assembled>;

template <class List> auto toSofaList(const std::vector<Vec3>& from)
{
    List list;
    list.reserve(from.size());
    for (const Vec3 each : from) list.push_back(toSofa(each));
    return list;
}

template <class List> void fromSofaList(const List& from, std::vector<Vec3>& out)
{
    out.clear();
    for (const auto& each : from) out.push_back(fromSofa(each));
}

topology::container::dynamic::TetrahedronSetTopologyContainer::SPtr topologyOf(const geometry::TetMesh& mesh)
{
    auto topology = New<topology::container::dynamic::TetrahedronSetTopologyContainer>();
    topology->setName("topology");
    topology->setNbPoints(static_cast<::sofa::Size>(mesh.nodes.size()));
    for (const Vec3 node : mesh.nodes) topology->addPoint(node.x, node.y, node.z);
    for (const geometry::Tetrahedron& t : mesh.tetrahedra)
        topology->addTetra(static_cast<::sofa::Index>(t[0]), static_cast<::sofa::Index>(t[1]),
                           static_cast<::sofa::Index>(t[2]), static_cast<::sofa::Index>(t[3]));
    return topology;
}

/// SOFA's threshold ends the iterations at a small p.Ap, whose default of 1e-5 kg m^2/s^2 a body of a few grams is
/// always below; only the tolerance shall end them.
template <class Gradients> typename Gradients::SPtr gradients(const physics::ConjugateGradient& def)
{
    auto solver = New<Gradients>();
    solver->d_maxIter.setValue(static_cast<unsigned>(def.maxIterations));
    solver->d_tolerance.setValue(def.tolerance);
    solver->d_smallDenominatorThreshold.setValue(std::numeric_limits<SReal>::min());
    solver->d_warmStart.setValue(false); // with it, a right side of zeros leaves the last step's solution
    return solver;
}

::sofa::core::objectmodel::BaseObject::SPtr solverOf(const physics::Solver& def)
{
    if (std::holds_alternative<physics::Cholesky>(def)) return New<CompliantFactor>();
    const auto& iterative = std::get<physics::ConjugateGradient>(def);
    if (iterative.assembled) return gradients<AssembledGradients>(iterative);
    return gradients<FreeGradients>(iterative);
}

/// Residuals that the solver noted, one per iteration, relative to the right side.
template <class Gradients> SolveOutcome outcomeOf(const Gradients& solver)
{
    const auto& graph = solver.d_graph.getValue();
    const auto found = graph.find("Error");
    if (found == graph.end() || found->second.empty()) return {};
    const double last = found->second.back();
    const int made = static_cast<int>(found->second.size()) - 1;
    return {.iterations = made,
            .residual = last,
            .atLimit = made >= static_cast<int>(solver.d_maxIter.getValue()) && last > solver.d_tolerance.getValue()};
}

} // namespace

SoftNode::SoftNode(BodyId id, SoftPlan plan)
    : id_(id), plan_(std::move(plan)), tissue_(std::make_shared<const SoftSettings::Tissue>(SoftSettings::Tissue{
                                           plan_.def.material, plan_.youngModulus, plan_.poissonRatio, plan_.tearing}))
{
}

// Delegating: if what follows throws, the destructor takes the node out of the graph.
SoftNode::SoftNode(BodyId id, SoftPlan plan, ::sofa::simulation::Node& root, const ContactStage& contact)
    : SoftNode(id, std::move(plan))
{
    node_ = root.createChild(text("body", id.value));
    coupled_ = contact.isExact() && !plan_.collision.empty();
    addSolver();
    add(topologyOf(plan_.mesh));
    state_ = New<State>();
    state_->setName("state");
    state_->resize(static_cast<::sofa::Size>(plan_.mesh.nodes.size()));
    const auto rest = toSofaList<Vec3Types::VecCoord>(plan_.mesh.nodes);
    state_->x.setValue(rest);
    state_->x0.setValue(rest);
    add(state_);
    auto mass = New<mass::DiagonalMass<Vec3Types>>();
    mass->d_vertexMass.setValue({plan_.masses.begin(), plan_.masses.end()});
    add(mass);
    addLaw();
    loads_ = New<BodyLoads>();
    loads_->setName("loads");
    loads_->surface = plan_.surface;
    loads_->forces = plan_.def.forces;
    loads_->pressure = plan_.def.pressure;
    if (!plan_.def.gravity) loads_->weightless = plan_.masses;
    add(loads_);
    for (const CollisionPlan& each : plan_.collision) {
        const ModelTag tag{
            .body = id, .soft = true, .friction = plan_.def.friction, .cuttable = mayBeCut(plan_.def, each.def.group)};
        surfaces_.push_back(addCollision(each, tag, contact, *state_));
    }
    ::sofa::simulation::node::init(node_.get());
    noteSystems();
    if (contact.constrains()) joinConstraints();
    setPins(plan_.pins);
}

SoftNode::~SoftNode()
{
    surfaces_.clear();
    if (node_) removeNode(node_);
}

void SoftNode::addSolver()
{
    if (const auto* explicitly = std::get_if<physics::ExplicitEuler>(&plan_.def.integrator)) {
        auto euler = New<odesolver::forward::EulerExplicitSolver>();
        euler->d_symplectic.setValue(explicitly->symplectic);
        add(euler);
        return;
    }
    auto euler = New<odesolver::backward::EulerImplicitSolver>();
    euler->d_rayleighMass.setValue(plan_.def.rayleigh.mass);
    euler->d_rayleighStiffness.setValue(plan_.def.rayleigh.stiffness);
    add(euler_ = euler);
    // Constraints need how far each other's forces move a body: only a factor gives that.
    solver_ = solverOf(coupled_ ? physics::Solver{physics::Cholesky{}} : plan_.def.solver);
    add(solver_);
}

void SoftNode::addLaw()
{
    law_ = lawOf(plan_, *state_);
    law_->setName("law");
    add(law_);
}

void SoftNode::joinConstraints()
{
    if (correction_) {
        correction_->cleanup(); // the constraint solver lists it
        drop(correction_);
    }
    if (coupled_ && solver_) {
        correction_ = New<constraint::lagrangian::correction::LinearSolverConstraintCorrection<Vec3Types>>();
    } else {
        const auto free = New<FreeCorrection<Vec3Types>>();
        if (coupled_)
            free->respond = free->eachAlone([this](std::size_t node, const Vec3Types::Deriv& impulse, double) {
                return impulse / plan_.masses[node];
            });
        correction_ = free;
    }
    add(correction_);
    correction_->init();
}

void SoftNode::setCoupled(bool coupled)
{
    if (std::exchange(coupled_, coupled) == coupled) return;
    try {
        remakeSolver();
    } catch (...) {
        coupled_ = !coupled;
        remakeSolver();
        throw;
    }
}

void SoftNode::remakeSolver()
{
    if (solver_ && !std::holds_alternative<physics::Cholesky>(plan_.def.solver)) {
        // The system that the old solver made would be found by the new one, and the old one by the integrator.
        for (auto* system : node_->getNodeObjects<::sofa::core::behavior::BaseMatrixLinearSystem>()) drop(system);
        drop(solver_);
        drop(euler_);
        addSolver();
        solver_->init();
        euler_->init();
        noteSystems();
    }
    joinConstraints();
}

SoftSettings SoftNode::settings() const
{
    return {.tissue = tissue_,
            .pins = pins_,
            .forces = loads_->forces,
            .pressure = loads_->pressure,
            .coupled = coupled_,
            .cut = cuts_ ? std::make_shared<const CutState>(CutState{plan_, *cuts_}) : nullptr};
}

bool SoftNode::isHeld(const geometry::Tetrahedron& nodes) const
{
    return std::ranges::all_of(nodes, [&](int node) { return held_[static_cast<std::size_t>(node)] != 0; });
}

void SoftNode::setCuts(std::unique_ptr<SoftCuts> cuts, std::shared_ptr<const SoftSettings::Tissue> tissue)
{
    cuts_ = std::move(cuts);
    tissue_ = std::move(tissue);
}

void SoftNode::add(const Component& component)
{
    own_.insert(component.get());
    node_->addObject(component);
}

void SoftNode::drop(const Component& component)
{
    own_.erase(component.get());
    node_->removeObject(component);
}

void SoftNode::noteSystems()
{
    for (const auto* system : node_->getNodeObjects<::sofa::core::behavior::BaseMatrixLinearSystem>())
        own_.insert(system);
}

bool SoftNode::isTuned() const
{
    return node_->child.size() > surfaces_.size() ||
           std::ranges::any_of(node_->object, [&](const auto& each) { return !own_.contains(each.get()); });
}

void SoftNode::apply(const SoftSettings& settings)
{
    if (coupled_ != settings.coupled) setCoupled(settings.coupled);
    if (tissue_ != settings.tissue) setTissue(settings.tissue);
    if (pins_ != settings.pins) setPins(settings.pins);
    loads_->forces = settings.forces;
    loads_->pressure = settings.pressure;
}

double SoftNode::speed() const
{
    double squared = 0.0;
    for (const auto& each : state_->v.getValue()) squared = std::max<double>(squared, each.norm2());
    return std::sqrt(squared);
}

void SoftNode::read(SoftState& out) const
{
    fromSofaList(state_->x.getValue(), out.positions);
    fromSofaList(state_->v.getValue(), out.velocities);
}

void SoftNode::write(const SoftState& state)
{
    state_->x.setValue(toSofaList<Vec3Types::VecCoord>(state.positions));
    state_->v.setValue(toSofaList<Vec3Types::VecDeriv>(state.velocities));
}

bool SoftNode::isUsable() const
{
    const auto near = [](const auto& list) {
        for (const auto& each : list)
            if (!(each.norm() < physics::kFarthest)) return false; // also NaN
        return true;
    };
    return near(state_->x.getValue()) && near(state_->v.getValue());
}

SolveOutcome SoftNode::outcome() const
{
    if (const auto* free = dynamic_cast<const FreeGradients*>(solver_.get())) return outcomeOf(*free);
    if (const auto* assembled = dynamic_cast<const AssembledGradients*>(solver_.get())) return outcomeOf(*assembled);
    return {.iterations = solver_ ? 1 : 0};
}

void SoftNode::setPins(std::vector<PinGroup> pins)
{
    pins_ = std::move(pins);
    std::vector<int> hard;
    loads_->springs.clear();
    held_ = goneNodes(plan_);
    for (std::size_t i = 0; i < held_.size(); ++i)
        if (held_[i] != 0) hard.push_back(static_cast<int>(i));
    for (const PinGroup& group : pins_)
        for (std::size_t i = 0; i < group.nodes.size(); ++i)
            if (group.stiffness == physics::kHard)
                hard.push_back(group.nodes[i]);
            else
                loads_->springs.push_back(
                    {static_cast<std::size_t>(group.nodes[i]), toSofa(group.places[i]), group.stiffness});
    std::ranges::sort(hard);
    hard.erase(std::ranges::unique(hard).begin(), hard.end());
    if (fixed_) drop(fixed_);
    fixed_.reset();
    if (hard.empty()) return;
    // The constraint cancels changes of velocity only: a node that moved when it was attached would go on.
    ::sofa::helper::WriteAccessor velocities(state_->v);
    for (const int each : hard) {
        velocities[static_cast<std::size_t>(each)].clear();
        held_[static_cast<std::size_t>(each)] = 1;
    }
    auto fixed = New<Fixed>();
    fixed->setName("pins");
    ::sofa::type::vector<::sofa::Index> indices;
    for (const int each : hard) indices.push_back(static_cast<::sofa::Index>(each));
    fixed->d_indices.setValue(indices);
    fixed_ = fixed;
    add(fixed_);
    fixed->init();
}

void SoftNode::setTissue(std::shared_ptr<const SoftSettings::Tissue> tissue)
{
    tissue_ = std::move(tissue);
    plan_.def.material = tissue_->material;
    if (cuts_) {
        cuts_->start.def.material = tissue_->material;
        cuts_->start.youngModulus = tissue_->youngModulus;
        cuts_->start.poissonRatio = tissue_->poissonRatio;
        cuts_->start.tearing = tissue_->tearing;
        inheritTissue(*cuts_, plan_);
    } else {
        plan_.youngModulus = tissue_->youngModulus;
        plan_.poissonRatio = tissue_->poissonRatio;
    }
    // An assembled system keeps what it made for the old law, and with it the law, until it begins anew: a change of
    // this value, even to the same, makes it.
    for (auto* system : node_->getNodeObjects<linearsystem::MatrixLinearSystem<Blocks, Assembled>>())
        system->d_checkIndices.setValue(false);
    drop(law_);
    addLaw();
    law_->init();
    law_->bwdInit();
}

} // namespace filasofia::sofaengine
