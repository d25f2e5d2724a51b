#include "filasofia/engine/soft/coarse_rebuild.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/soft/assembled_system.h"
#include "filasofia/engine/soft/coarse_matrix.h"
#include "filasofia/engine/soft/coarse_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

std::vector<std::array<int, 2>> connections(const SoftModel& model)
{
    std::vector<std::array<int, 2>> edges;
    for (const FemElement& e : model.elements)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < i; ++j) edges.push_back({e.nodes[i], e.nodes[j]});
    for (const Spring& spring : model.springs) edges.push_back(spring.nodes);
    const std::vector<std::array<int, 2>> sheet = edgesOf(model.shell);
    edges.insert(edges.end(), sheet.begin(), sheet.end());
    return edges;
}

/// Per cluster the numbers of its nodes among the unknowns; -1 where it has fewer.
std::vector<int> unknownsOf(const geometry::CoarseLattice& clusters, std::span<const int> nodes)
{
    std::vector<int> numberOf(clusters.corners.size(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i) numberOf[static_cast<std::size_t>(nodes[i])] = static_cast<int>(i);
    std::vector<int> out(clusters.pieces.size() * linalg::kPieceNodes, -1);
    for (std::size_t k = 0; k < clusters.pieces.size(); ++k)
        for (std::size_t i = 0; i < clusters.pieces[k].size(); ++i)
            out[k * linalg::kPieceNodes + i] = numberOf[static_cast<std::size_t>(clusters.pieces[k][i])];
    return out;
}

/// The blocks of a matrix that belong to clusters.
std::vector<double> blocksOf(const geometry::CoarseLattice& clusters, const linalg::BlockSparseMatrix& all,
                             double scale)
{
    CoarseMatrix out(clusters);
    for (const std::vector<int>& cluster : clusters.pieces)
        for (int row : cluster)
            for (int column : cluster) {
                const int i = clusters.corners[static_cast<std::size_t>(row)][0];
                const int k = clusters.corners[static_cast<std::size_t>(column)][0];
                const int at = k > i ? -1 : all.find(row, column);
                if (at < 0) continue;
                const CoarseMatrix::Block block = out.block(i, k);
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 3; ++c)
                        block.add(r, c, scale * all.block(at)[static_cast<int>(r)][static_cast<int>(c)]);
            }
    return {out.pieces().begin(), out.pieces().end()};
}

} // namespace

CoarseChoice coarseChoice(std::size_t freeNodes)
{
    return {.target = std::clamp(static_cast<int>(0.37 * std::pow(static_cast<double>(freeNodes), 0.72)), 12, 400)};
}

CoarseChoice coarseChoiceAfterCut(std::size_t freeNodes)
{
    constexpr int kCheap = 150;
    const int target = coarseChoice(freeNodes).target;
    return {.target = std::max(target, std::min(2 * target, kCheap)), .most = kCheap};
}

linalg::TwoLevelPreconditioner preconditionerAtRest(const SoftModel& model, const PreconditionerPlan& plan,
                                                    const CoarseChoice& choice)
{
    AssembledSystem rest(model);
    SoftState state = stateAtStart(model);
    assembleMatrix(model, std::vector<Vec3>(model.rest.size()), plan.period, 1.0, state, rest);
    const std::vector<std::array<int, 2>> edges = connections(model);
    const CoarseMesh mesh{model.rest, edges, plan.nodes, model.pins.hard, model.pins.springs, model.masses};
    const auto [lattice, isFree] = buildLattice(mesh, choice);
    linalg::TwoLevelPreconditioner made({.matrix = rest.matrix,
                                         .rows = plan.nodes,
                                         .scale = plan.scale,
                                         .coarseNodes = lattice.nodeCount,
                                         .freePieces = isFree,
                                         .corners = lattice.corners,
                                         .weights = lattice.weights,
                                         .blocks = plan.blocks});
    if (hasShortEdges(mesh)) {
        const geometry::CoarseLattice clusters = clusterLattice(mesh, lattice);
        made.setClusters({unknownsOf(clusters, plan.nodes), blocksOf(clusters, rest.matrix, plan.scale)});
    }
    return made;
}

/// Input and result of a rebuild. The step that starts it copies only what is needed, and no other thread shares the
/// data.
struct CoarseRebuild::Work {
    struct Element {
        geometry::Tetrahedron nodes;
        Lame material;
        double nodalBulk;
    };
    std::vector<int> nodes;
    double scale;
    ImplicitWeights weights;
    std::vector<Element> elements;
    std::vector<Spring> springs;
    Shell shell;
    std::vector<Vec3> rest;
    std::vector<double> masses;
    std::vector<bool> held;
    std::vector<PinSpring> pins;
    bool clustered;
    linalg::CoarseLevel made;
    linalg::ClusterSmoother clusters;

    Work(const SoftModel& model, const PreconditionerPlan& plan)
        : nodes(plan.nodes.begin(), plan.nodes.end()), scale(plan.scale),
          weights(implicitWeights(plan.period, {model.rayleigh.mass, model.rayleigh.stiffness},
                                  relaxationTangent(model.material.relaxation, plan.period))),
          springs(model.springs), shell(model.shell), rest(model.rest), masses(model.masses), held(model.pins.hard),
          pins(model.pins.springs), clustered(plan.clustered)
    {
        elements.reserve(model.elements.size());
        for (const FemElement& each : model.elements) elements.push_back({each.nodes, lameOf(each), nodalBulk(each)});
    }

    void make();
    [[nodiscard]] std::vector<std::array<int, 2>> edges() const;
    [[nodiscard]] CoarseMatrix coarseMatrix(const geometry::CoarseLattice& lattice) const;
    void addVolumes(const geometry::CoarseLattice& lattice, CoarseMatrix& matrix) const;
    void addShell(const geometry::CoarseLattice& lattice, CoarseMatrix& matrix) const;
};

void CoarseRebuild::Work::make()
{
    const std::vector<std::array<int, 2>> connected = edges();
    const CoarseMesh mesh{rest, connected, nodes, held, pins, masses};
    const auto [lattice, isFree] = buildLattice(mesh, coarseChoiceAfterCut(nodes.size()));
    if (clustered) {
        const geometry::CoarseLattice ofClusters = clusterLattice(mesh, lattice);
        clusters = {unknownsOf(ofClusters, nodes), coarseMatrix(ofClusters).pieces()};
    }
    if (lattice.nodeCount > 0 || !lattice.pieces.empty()) {
        const CoarseMatrix matrix = coarseMatrix(lattice);
        made = linalg::CoarseLevel(linalg::CoarseInput{.matrix = matrix.lattice(),
                                                       .pieces = matrix.pieces(),
                                                       .freePieces = isFree,
                                                       .coarseNodes = lattice.nodeCount,
                                                       .rows = nodes,
                                                       .corners = lattice.corners,
                                                       .weights = lattice.weights});
    }
    springs = {};
    shell = {};
    elements = {}; // freed here, as the step has no time for it
    rest = {};
}

/// Each edge once: a mesh has five times fewer edges than its elements have together.
std::vector<std::array<int, 2>> CoarseRebuild::Work::edges() const
{
    std::vector<std::array<int, 2>> list;
    list.reserve(6 * elements.size() + springs.size() + 3 * shell.membranes.size());
    for (const Spring& spring : springs) list.push_back(spring.nodes);
    for (const Element& each : elements)
        for (const auto& [i, j] : geometry::kTetrahedronEdges) {
            const auto [low, high] = std::minmax(each.nodes[i], each.nodes[j]);
            list.push_back({low, high});
        }
    for (const MembraneElement& each : shell.membranes)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(each.nodes[i], each.nodes[(i + 1) % 3]);
            list.push_back({low, high});
        }
    sortUnique(list);
    return list;
}

/// Triangles at rest. A tangent is a quadratic form in a few rates that are linear in the nodes: those by which two
/// edges and three angles change.
void CoarseRebuild::Work::addShell(const geometry::CoarseLattice& lattice, CoarseMatrix& matrix) const
{
    const double weight = scale * weights.stiffness;
    CoarseSum<Vec3> edgeRates; // shares of the edges 01 and 02
    for (const MembraneElement& each : shell.membranes) {
        const MembraneTangent k = membraneTangent(each, vectorsAt(each.nodes, rest));
        edgeRates.clear();
        edgeRates.add(lattice, static_cast<std::size_t>(each.nodes[0]), {-1.0, -1.0, 0.0});
        edgeRates.add(lattice, static_cast<std::size_t>(each.nodes[1]), {1.0, 0.0, 0.0});
        edgeRates.add(lattice, static_cast<std::size_t>(each.nodes[2]), {0.0, 1.0, 0.0});
        forEachPair(edgeRates, matrix, [&](const CoarseMatrix::Block& block, Vec3 a, Vec3 b) {
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c)
                    block.add(r, c,
                              weight * (a.x * b.x * k.aa[r][c] + a.x * b.y * k.ab[r][c] + a.y * b.x * k.ab[c][r] +
                                        a.y * b.y * k.bb[r][c]));
        });
    }
    CoarseSum<Mat3> angleRates; // the gradients of the three angles as rows
    for (const BendingElement& each : shell.bends) {
        const BendingTangent k = bendingTangent(each, vectorsAt(each.nodes, rest));
        const auto& [s00, s01, s02, s11, s12, s22] = k.stiffness;
        const Mat3 s = Mat3::columns({s00, s01, s02}, {s01, s11, s12}, {s02, s12, s22});
        angleRates.clear();
        for (std::size_t i = 0; i < 6; ++i)
            angleRates.add(lattice, static_cast<std::size_t>(each.nodes[i]),
                           transpose(Mat3::columns(k.gradients[0][i], k.gradients[1][i], k.gradients[2][i])));
        forEachPair(angleRates, matrix, [&](const CoarseMatrix::Block& block, const Mat3& a, const Mat3& b) {
            const Mat3 product = weight * (transpose(a) * (s * b));
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) block.add(r, c, product[r][c]);
        });
    }
}

/// The volumes of nodes (nodal_volume.h).
void CoarseRebuild::Work::addVolumes(const geometry::CoarseLattice& lattice, CoarseMatrix& matrix) const
{
    std::vector<std::vector<std::size_t>> around(rest.size());
    for (std::size_t e = 0; e < elements.size(); ++e)
        if (elements[e].nodalBulk > 0.0)
            for (int node : elements[e].nodes) around[static_cast<std::size_t>(node)].push_back(e);
    CoarseSum<Vec3> sum;
    for (const std::vector<std::size_t>& each : around) {
        sum.clear();
        double stiffness = 0.0;
        for (std::size_t e : each) {
            const Corners corners = cornersOf(elements[e].nodes, rest), gradients = shapeGradients(corners);
            const double share = 0.25 * elements[e].nodalBulk * volumeOf(corners);
            stiffness += share;
            for (std::size_t i = 0; i < 4; ++i)
                sum.add(lattice, static_cast<std::size_t>(elements[e].nodes[i]), share * gradients[i]);
        }
        if (stiffness == 0.0) continue;
        const double weight = scale * weights.stiffness / stiffness;
        forEachPair(sum, matrix, [&](const CoarseMatrix::Block& block, Vec3 a, Vec3 b) {
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) block.add(r, c, weight * a[r] * b[c]);
        });
    }
}

/// P^T A P without A: the stiffness of an element is bilinear in the gradients of its shape functions, and the
/// gradients of the coarse nodes are weighted sums of them. Only the lower half is computed. Fibres and scales at rest
/// are left out: the coarse level only has to be near.
CoarseMatrix CoarseRebuild::Work::coarseMatrix(const geometry::CoarseLattice& lattice) const
{
    CoarseMatrix matrix(lattice);
    CoarseSum<Vec3> sum;
    for (const Element& each : elements) {
        const Corners corners = cornersOf(each.nodes, rest), gradients = shapeGradients(corners);
        sum.clear();
        for (std::size_t i = 0; i < 4; ++i) sum.add(lattice, static_cast<std::size_t>(each.nodes[i]), gradients[i]);
        const double weight = scale * weights.law * volumeOf(corners);
        const double mu = weight * each.material.mu, lambda = weight * each.material.lambda;
        forEachPair(sum, matrix, [&](const CoarseMatrix::Block& block, Vec3 a, Vec3 b) {
            const double shear = mu * dot(a, b);
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c)
                    block.add(r, c, lambda * a[r] * b[c] + mu * b[r] * a[c] + (r == c ? shear : 0.0));
        });
    }
    addVolumes(lattice, matrix);
    addShell(lattice, matrix);
    CoarseSum<double> ends;
    for (const Spring& spring : springs) {
        const Mat3 stiffness = scale * springMatrix(spring, weights, rest);
        ends.clear();
        ends.add(lattice, static_cast<std::size_t>(spring.nodes[0]), 1.0);
        ends.add(lattice, static_cast<std::size_t>(spring.nodes[1]), -1.0);
        forEachPair(ends, matrix, [&](const CoarseMatrix::Block& block, double a, double b) {
            for (std::size_t r = 0; r < 3; ++r)
                for (std::size_t c = 0; c < 3; ++c) block.add(r, c, a * b * stiffness[r][c]);
        });
    }
    const auto addNode = [&](int node, double value) {
        CoarseSum<double> share;
        share.add(lattice, static_cast<std::size_t>(node), 1.0);
        forEachPair(share, matrix, [&](const CoarseMatrix::Block& block, double a, double b) {
            for (std::size_t k = 0; k < 3; ++k) block.add(k, k, value * a * b);
        });
    };
    for (int node : nodes) addNode(node, scale * weights.mass * masses[static_cast<std::size_t>(node)]);
    for (const PinSpring& pin : pins)
        if (!held[static_cast<std::size_t>(pin.node)]) addNode(pin.node, scale * weights.stiffness * pin.stiffness);
    return matrix;
}

namespace {

/// The number of steps in 2.5 times the build time on one core: the cost of lattice and matrix is proportional to the
/// number of elements, that of the inverse to the cube of the number of coarse nodes. Measured at 1000 to 85,000
/// elements: 14 ms at 5400, 23 ms at 20,000, 184 ms at 85,000.
int stepsToBuild(std::size_t elements, const PreconditionerPlan& plan)
{
    constexpr double kPerElement = 1e-6, kInverse = 9e-3; // [s], the second for 150 coarse nodes
    constexpr double kPerClusteredNode = 1e-5;            // [s]
    constexpr double kMinSteps = 4.0, kMaxSteps = 10000.0;
    const std::size_t freeNodes = plan.nodes.size();
    const CoarseChoice choice = coarseChoiceAfterCut(freeNodes);
    const auto maxCoarse = static_cast<double>(std::max(choice.target, choice.most));
    const double coarse = std::min(maxCoarse, static_cast<double>(freeNodes)) / 150.0;
    double seconds = kPerElement * static_cast<double>(elements) + kInverse * coarse * coarse * coarse;
    if (plan.clustered) seconds += kPerClusteredNode * static_cast<double>(freeNodes);
    return static_cast<int>(std::clamp(std::ceil(2.5 * seconds / plan.period), kMinSteps, kMaxSteps));
}

} // namespace

CoarseRebuild::CoarseRebuild(const SoftModel& model, const PreconditionerPlan& plan, BackgroundThread& meanwhile)
    : work_(std::make_shared<Work>(model, plan)),
      job_(std::make_shared<BackgroundJob>([work = work_] { work->make(); })),
      stepsLeft_(stepsToBuild(model.elements.size() + model.springs.size() + 3 * model.shell.membranes.size(), plan))
{
    meanwhile.submit(job_);
}

CoarseRebuild::CoarseRebuild(const CoarseRebuild& other) : stepsLeft_(other.stepsLeft_), since_(other.since_)
{
    other.job_->finish();
    work_ = std::make_shared<Work>(*other.work_);
    job_ = std::make_shared<BackgroundJob>([] {}); // the work is done
}

CoarseRebuild::~CoarseRebuild() { job_->drop(); }

linalg::ClusterSmoother&& CoarseRebuild::takeClusters() { return std::move(work_->clusters); }

linalg::CoarseLevel&& CoarseRebuild::take()
{
    job_->finish();
    return std::move(work_->made);
}

} // namespace filasofia::engine
