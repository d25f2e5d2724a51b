#include "filasofia/sofa/tie.h"

#include "filasofia/sofa/collision_node.h"
#include "filasofia/sofa/node_removal.h"

#include <sofa/component/mapping/nonlinear/RigidMapping.h>
#include <sofa/simulation/Simulation.h>

#include <cmath>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::objectmodel::New;

constexpr double kFastest = 0.1; // [m/s] at which a weld draws its points together, as surfaces part in our engine

void addPoint(Hasher& hash, const TiePoint& point)
{
    for (std::size_t i = 0; i < 4; ++i) {
        hash.add(static_cast<std::uint64_t>(point.nodes[i]));
        hash.add(point.weights[i]);
    }
}

} // namespace

void addTo(Hasher& hash, const TieState& tie)
{
    hash.add(std::uint64_t{tie.report.id.value});
    for (const TieEnd* end : {&tie.body, &tie.to}) {
        hash.add(std::uint64_t{end->id.value});
        hash.add(static_cast<std::uint64_t>(end->element));
        hash.addAll(std::span<const Vec3>(end->points));
    }
    for (const double each : {tie.law.stiffness, tie.law.breakForce, tie.law.pointBreakForce, tie.law.cutDistance})
        hash.add(each);
    for (const TieRows::Pair& pair : tie.pairs) {
        addPoint(hash, pair.first);
        addPoint(hash, pair.second);
        const Vec3 both[] = {pair.apart, pair.force};
        hash.addAll(std::span<const Vec3>(both));
    }
}

Vec3 worldPoint(const RigidNode& body, int element, Vec3 point)
{
    RigidState now;
    body.read(now);
    return transform(now.poses[static_cast<std::size_t>(element)], body.plan().inertia.centre + point);
}

Tie::Tie(TieState state, const std::array<Side, 2>& sides, ::sofa::simulation::Node& root)
    : state_(std::move(state)), sides_(sides), root_(root)
{
}

// Delegating: if what follows throws, the destructor takes apart what is there.
Tie::Tie(TieState state, const Side& body, const Side& to, ::sofa::simulation::Node& root)
    : Tie(std::move(state), std::array{body, to}, root)
{
    TieRows::States* first = statesOf(0);
    const bool space = !state_.to.id;
    rows_ = New<TieRows>(first, space ? first : statesOf(1));
    rows_->space = space;
    rows_->stiffness = state_.law.stiffness;
    rows_->fastest = kFastest;
    rows_->pairs = std::exchange(state_.pairs, {});
    root_.addObject(rows_);
    rows_->init();
}

Tie::~Tie()
{
    if (rows_ && rows_->getContext() == &root_) root_.removeObject(rows_);
    for (auto& node : nodes_) removeNode(node);
}

TieState Tie::state() const
{
    TieState state = state_;
    state.pairs = rows_->pairs;
    return state;
}

/// Points of a rigid element get a node of their own.
TieRows::States* Tie::statesOf(std::size_t side)
{
    if (sides_[side].soft) return &sides_[side].soft->states();
    const RigidNode& body = *sides_[side].rigid;
    Vec3Types::VecCoord local, world;
    for (const Vec3 point : end(side).points) {
        local.push_back(toSofa(point));
        world.push_back(toSofa(worldPoint(body, end(side).element, point)));
    }
    const auto node = nodes_.emplace_back(body.node().createChild("tie"));
    const auto states = New<SoftStates>();
    states->resize(static_cast<::sofa::Size>(world.size()));
    states->x.setValue(world);
    states->x0.setValue(world);
    node->addObject(states);
    const auto mapping = New<::sofa::component::mapping::nonlinear::RigidMapping<RigidTypes, Vec3Types>>();
    mapping->setModels(&body.states(), states.get());
    mapping->d_points.setValue(local);
    mapping->d_index.setValue(static_cast<::sofa::Index>(end(side).element));
    node->addObject(mapping);
    ::sofa::simulation::node::init(node.get());
    return states.get();
}

Vec3 Tie::placeOf(std::size_t side, const TiePoint& point) const
{
    if (sides_[side].rigid)
        return worldPoint(*sides_[side].rigid, end(side).element,
                          end(side).points[static_cast<std::size_t>(point.nodes[0])]);
    const auto& x = sides_[side].soft->states().x.getValue();
    Vec3 place;
    for (std::size_t i = 0; i < 4; ++i)
        place += point.weights[i] * fromSofa(x[static_cast<std::size_t>(point.nodes[i])]);
    return place;
}

void Tie::finish(std::span<const double> impulses, double dt)
{
    rows_->readForces(impulses, dt);
    frame::Attachment& report = state_.report;
    report.force = {};
    for (const TieRows::Pair& each : rows_->pairs) report.force += each.force;
    report.parted = static_cast<int>(std::erase_if(
        rows_->pairs, [&](const TieRows::Pair& each) { return length(each.force) > state_.law.pointBreakForce; }));
    report.points = static_cast<int>(rows_->pairs.size());
    report.broken = report.points == 0 || length(report.force) > state_.law.breakForce;
}

std::vector<Vec3> Tie::places() const
{
    std::vector<Vec3> places;
    for (const TieRows::Pair& each : rows_->pairs) places.push_back(placeOf(0, each.first));
    return places;
}

void Tie::cut(const std::function<bool(Vec3)>& parts)
{
    const auto gone =
        std::erase_if(rows_->pairs, [&](const TieRows::Pair& each) { return parts(placeOf(0, each.first)); });
    if (gone == 0) return;
    frame::Attachment& report = state_.report;
    report.parted += static_cast<int>(gone);
    report.points = static_cast<int>(rows_->pairs.size());
    report.broken = report.broken || report.points == 0;
}

void Tie::addForces(std::vector<PointForce>& out) const
{
    for (const TieRows::Pair& each : rows_->pairs) {
        out.push_back({state_.body.id, state_.body.element, placeOf(0, each.first), each.force});
        if (rows_->space) continue;
        out.push_back({state_.to.id, state_.to.element, placeOf(1, each.second), -each.force});
    }
}

void Tie::rewind()
{
    rows_->pairs = state_.whole;
    for (TieRows::Pair& each : rows_->pairs) {
        each.force = {};
        if (rows_->space || std::isfinite(state_.law.stiffness)) continue;
        each.apart = placeOf(0, each.first) - placeOf(1, each.second);
    }
    frame::Attachment& report = state_.report;
    report = {.id = report.id, .body = report.body, .to = report.to, .points = static_cast<int>(rows_->pairs.size())};
}

} // namespace filasofia::sofaengine
