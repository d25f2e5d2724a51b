#include "filasofia/geometry/coarse_lattice.h"

#include "engine/meshes.h"
#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/mesh_file.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

namespace coarse_lattice_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

using Edges = std::vector<std::array<int, 2>>;

CoarseLattice latticeOf(const TetMesh& mesh, int target)
{
    return coarseLattice(mesh.nodes, edges(mesh), std::vector<bool>(mesh.nodes.size(), true), target);
}

// Per coarse node, the sum of its weights.
std::vector<double> supports(const CoarseLattice& lattice)
{
    std::vector<double> support(static_cast<std::size_t>(lattice.nodeCount), 0.0);
    for (std::size_t i = 0; i < lattice.corners.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            if (lattice.weights[i][k] != 0.0f) support[lattice.corners[i][k]] += lattice.weights[i][k];
    return support;
}

double sumOf(const std::array<float, 4>& weights) { return double(weights[0]) + weights[1] + weights[2] + weights[3]; }

// Invariants of every lattice: weights are non-negative and sum to 1, corners are coarse nodes, and every coarse node
// is used.
void checkSound(const CoarseLattice& lattice, const std::vector<bool>& active)
{
    REQUIRE(lattice.corners.size() == active.size());
    REQUIRE(lattice.weights.size() == active.size());
    double worst = 0.0;
    bool inRange = true;
    for (std::size_t i = 0; i < active.size(); ++i) {
        worst = std::max(worst, std::abs(sumOf(lattice.weights[i]) - (active[i] ? 1.0 : 0.0)));
        for (std::size_t k = 0; k < 4; ++k) {
            const int corner = lattice.corners[i][k];
            inRange &= lattice.weights[i][k] >= 0.0f;
            inRange &= active[i] ? corner >= 0 && corner < lattice.nodeCount : lattice.weights[i][k] == 0.0f;
        }
    }
    CHECK(worst < 1e-6);
    REQUIRE(inRange);
    for (double support : supports(lattice)) REQUIRE(support > 0.0);
}

void checkSound(const CoarseLattice& lattice) { checkSound(lattice, std::vector<bool>(lattice.corners.size(), true)); }

bool isEmpty(const CoarseLattice& lattice)
{
    return lattice.nodeCount == 0 && lattice.pieces.empty() &&
           std::ranges::all_of(lattice.weights, [](const std::array<float, 4>& w) { return w == decltype(w){}; });
}

// The coarse nodes in which the nodes that satisfy `where` are embedded.
template <class Where> std::set<int> usedWhere(const CoarseLattice& lattice, const TetMesh& mesh, Where&& where)
{
    std::set<int> used;
    for (int i : nodesWhere(mesh, where))
        for (std::size_t k = 0; k < 4; ++k)
            if (lattice.weights[i][k] > 0.0f) used.insert(lattice.corners[i][k]);
    return used;
}

bool meet(const std::set<int>& a, const std::set<int>& b)
{
    return std::ranges::any_of(a, [&](int c) { return b.contains(c); });
}

TetMesh together(TetMesh a, const TetMesh& b, Vec3 shift)
{
    const int first = static_cast<int>(a.nodes.size());
    for (Vec3 p : b.nodes) a.nodes.push_back(p + shift);
    for (auto [i, j, k, l] : b.tetrahedra) a.tetrahedra.push_back({first + i, first + j, first + k, first + l});
    return a;
}

// The distance between `field` and the fields that the lattice spans, at the nodes in `fitted`: the least-squares
// residual, found by conjugate gradients on the normal equations, scaled by their diagonal.
std::vector<double> residualOf(const CoarseLattice& lattice, const std::vector<double>& field,
                               const std::vector<int>& fitted)
{
    const std::size_t n = static_cast<std::size_t>(lattice.nodeCount);
    const auto interpolate = [&](const std::vector<double>& x, int i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 4; ++k) sum += double(lattice.weights[i][k]) * x[lattice.corners[i][k]];
        return sum;
    };
    std::vector<double> x(n, 0.0), r(n, 0.0), diagonal(n, 1e-12), z(n), q(n);
    for (int i : fitted)
        for (std::size_t k = 0; k < 4; ++k) {
            const double w = lattice.weights[i][k];
            r[lattice.corners[i][k]] += w * field[i];
            diagonal[lattice.corners[i][k]] += w * w;
        }
    std::vector<double> p(n, 0.0);
    double before = 1.0;
    for (int step = 0; step < 2000; ++step) {
        for (std::size_t c = 0; c < n; ++c) z[c] = r[c] / diagonal[c];
        const double now = std::inner_product(r.begin(), r.end(), z.begin(), 0.0);
        if (now < 1e-24) break;
        for (std::size_t c = 0; c < n; ++c) p[c] = z[c] + (step > 0 ? now / before : 0.0) * p[c];
        before = now;
        std::ranges::fill(q, 0.0);
        for (int i : fitted)
            for (std::size_t k = 0; k < 4; ++k)
                q[lattice.corners[i][k]] += double(lattice.weights[i][k]) * interpolate(p, i);
        const double step2 = now / std::inner_product(p.begin(), p.end(), q.begin(), 0.0);
        for (std::size_t c = 0; c < n; ++c) x[c] += step2 * p[c], r[c] -= step2 * q[c];
    }
    std::vector<double> residual(field.size());
    for (std::size_t i = 0; i < field.size(); ++i)
        residual[i] = std::abs(field[i] - interpolate(x, static_cast<int>(i)));
    return residual;
}

} // namespace

TEST_CASE("a coarse lattice has about as many nodes as asked for, on boxes, beams, membranes and bunnies")
{
    std::vector<TetMesh> meshes;
    meshes.push_back(boxMesh({14, 14, 14}, {0.1, 0.1, 0.1}, 0.2));
    meshes.push_back(boxMesh({50, 8, 8}, {0.5, 0.08, 0.08}));
    meshes.push_back(boxMesh({50, 50, 2}, {0.1, 0.1, 0.002}, 0.1));
    for (int elements : {3004, 10000, 30000}) meshes.push_back(loadTetMesh(bunnyFile(elements)));
    for (const TetMesh& mesh : meshes)
        for (int asked : {30, 45, 60, 120, 250, 450}) {
            CAPTURE(mesh.nodes.size(), asked);
            const int target = std::min(asked, static_cast<int>(mesh.nodes.size()) / 4);
            const CoarseLattice lattice = latticeOf(mesh, asked);
            CHECK(lattice.nodeCount <= 1.05 * target);
            CHECK(lattice.nodeCount >= 0.9 * target);
            checkSound(lattice);
        }
}

TEST_CASE("no coarse node of the bunny holds less than a hundredth of what the median one holds")
{
    for (int elements : {1492, 3004, 10000, 30000})
        for (int target : {40, 100, 450}) {
            CAPTURE(elements, target);
            std::vector<double> support = supports(latticeOf(loadTetMesh(bunnyFile(elements)), target));
            std::ranges::sort(support);
            CHECK(support.front() > 0.01 * support[support.size() / 2]);
        }
}

TEST_CASE("a coarse lattice follows every linear field, exactly except at the few nodes whose coarse node was dropped")
{
    std::mt19937 random(3);
    for (int target : {4, 60, 250}) {
        CAPTURE(target);
        const TetMesh mesh = boxMesh({12, 12, 12}, {1.0, 1.0, 1.0}, 0.2);
        const CoarseLattice lattice = latticeOf(mesh, target);
        const Vec3 slope = randomVec3(random, 1.0);
        std::vector<double> field;
        for (Vec3 p : mesh.nodes) field.push_back(0.3 + dot(slope, p));

        std::vector<int> fitted(mesh.nodes.size());
        std::iota(fitted.begin(), fitted.end(), 0);
        std::vector<double> residual = residualOf(lattice, field, fitted);
        CHECK(*std::ranges::max_element(residual) < 0.1);
        const double square = std::inner_product(residual.begin(), residual.end(), residual.begin(), 0.0);
        CHECK(std::sqrt(square / double(residual.size())) < 0.01);

        // Without the worst nodes, only the rounding of the weights is left.
        for (int round = 0; round < 8; ++round) {
            std::ranges::stable_sort(fitted, [&](int a, int b) { return residual[a] < residual[b]; });
            fitted.resize(fitted.size() - mesh.nodes.size() / 50);
            residual = residualOf(lattice, field, fitted);
        }
        double worst = 0.0;
        for (int i : fitted) worst = std::max(worst, residual[i]);
        CHECK(worst < 1e-5);
    }
}

TEST_CASE("two boxes a millimetre apart share no coarse node")
{
    const TetMesh one = boxMesh({8, 8, 8}, {0.1, 0.1, 0.1});
    const TetMesh both = together(one, one, {0.101, 0, 0});
    for (int target : {30, 120, 250}) {
        const CoarseLattice lattice = latticeOf(both, target);
        checkSound(lattice);
        const std::set<int> left = usedWhere(lattice, both, [](Vec3 p) { return p.x < 0.1005; });
        const std::set<int> right = usedWhere(lattice, both, [](Vec3 p) { return p.x > 0.1005; });
        CHECK_FALSE(meet(left, right));
        CHECK(left.size() >= 4);
        CHECK(right.size() >= 4);
        CHECK(static_cast<int>(left.size() + right.size()) == lattice.nodeCount);
    }
}

TEST_CASE("two prongs with a slit between them share coarse nodes where they join and none at their tips")
{
    // Every element of one layer is removed, except at the end where the prongs join.
    TetMesh mesh = boxMesh({30, 21, 6}, {0.3, 0.105, 0.06});
    std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& t) {
        const Vec3 centre = 0.25 * (mesh.nodes[t[0]] + mesh.nodes[t[1]] + mesh.nodes[t[2]] + mesh.nodes[t[3]]);
        return centre.x > 0.05 && std::abs(centre.y - 0.0525) < 0.0025;
    });
    for (int target : {60, 120, 400}) {
        CAPTURE(target);
        const CoarseLattice lattice = latticeOf(mesh, target);
        checkSound(lattice);
        const auto prong = [&](bool upper, double from, double to) {
            return usedWhere(lattice, mesh,
                             [=](Vec3 p) { return p.x >= from && p.x <= to && (upper ? p.y > 0.0525 : p.y < 0.0525); });
        };
        CHECK_FALSE(meet(prong(false, 0.22, 1.0), prong(true, 0.22, 1.0)));
        CHECK(meet(prong(false, 0.0, 0.045), prong(true, 0.0, 0.045)));
    }
}

TEST_CASE("nodes that are not active are left out, and connect nothing")
{
    const TetMesh mesh = boxMesh({21, 8, 8}, {0.21, 0.08, 0.08});
    std::vector<bool> active(mesh.nodes.size());
    for (std::size_t i = 0; i < active.size(); ++i) active[i] = std::abs(mesh.nodes[i].x - 0.1) > 0.005;
    const CoarseLattice lattice = coarseLattice(mesh.nodes, edges(mesh), active, 60);
    CHECK(lattice.nodeCount > 50);
    checkSound(lattice, active);
    CHECK_FALSE(meet(usedWhere(lattice, mesh, [](Vec3 p) { return p.x < 0.095; }),
                     usedWhere(lattice, mesh, [](Vec3 p) { return p.x > 0.105; })));
}

TEST_CASE("the same body gives the same lattice, and with its nodes in another order the same cells")
{
    const TetMesh mesh = loadTetMesh(bunnyFile(3004));
    const CoarseLattice first = latticeOf(mesh, 120), second = latticeOf(mesh, 120);
    CHECK(first.corners == second.corners);
    CHECK(first.weights == second.weights);

    std::vector<int> order(mesh.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    TetMesh shuffled = mesh;
    for (std::size_t i = 0; i < order.size(); ++i) shuffled.nodes[order[i]] = mesh.nodes[i];
    for (Tetrahedron& t : shuffled.tetrahedra)
        for (int& node : t) node = order[node];
    const CoarseLattice third = latticeOf(shuffled, 120);
    CHECK(third.nodeCount == first.nodeCount);
    double worst = 0.0;
    for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            worst = std::max(worst, double(std::abs(third.weights[order[i]][k] - first.weights[i][k])));
    CHECK(worst < 1e-6);
}

TEST_CASE("flat, straight, shrunk and stretched bodies get a lattice of finite weights")
{
    const TetMesh box = boxMesh({6, 6, 6}, {1.0, 1.0, 1.0}, 0.2);
    const auto moved = [&](auto&& where) {
        TetMesh mesh = box;
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i) mesh.nodes[i] = where(mesh.nodes[i], i);
        const CoarseLattice lattice = latticeOf(mesh, 30);
        checkSound(lattice);
        return lattice.nodeCount;
    };
    CHECK(moved([](Vec3 p, std::size_t) { return Vec3{p.x, p.y, 0.0}; }) >= 20);
    CHECK(moved([](Vec3 p, std::size_t) { return Vec3{p.x, 2.0 * p.x, 3.0 * p.x}; }) >= 4);
    CHECK(moved([](Vec3, std::size_t) { return Vec3{1.0, 2.0, 3.0}; }) == 1);
    CHECK(moved([](Vec3 p, std::size_t) { return 1e-160 * p; }) >= 1);
    CHECK(moved([](Vec3 p, std::size_t) { return 1e99 * p; }) >= 20);
    CHECK(moved([](Vec3 p, std::size_t i) { return i == 70 ? Vec3{1e6, 0, 0} : p; }) >= 1);
    CHECK(moved([](Vec3 p, std::size_t i) { return i == 70 ? Vec3{1e60, 0, -1e60} : p; }) >= 1);
    CHECK(moved([](Vec3 p, std::size_t) { return Vec3{p.x, 1e-3 * p.y, 1e3 * p.z}; }) >= 4);
    CHECK(moved([](Vec3 p, std::size_t) { return p + Vec3{1e9, -1e9, 1e9}; }) >= 20);
}

TEST_CASE("there is no lattice if it would not pay, and none for numbers that are not finite")
{
    const TetMesh box = boxMesh({4, 4, 4}, {1.0, 1.0, 1.0});
    const Edges all = edges(box);
    CHECK(isEmpty(coarseLattice({}, {}, {}, 100)));
    CHECK(isEmpty(latticeOf(box, 3)));
    CHECK(isEmpty(latticeOf(box, 0)));
    CHECK(isEmpty(latticeOf(box, -5)));
    CHECK(isEmpty(coarseLattice(box.nodes, all, std::vector<bool>(box.nodes.size(), false), 30)));
    CHECK(latticeOf(box, 1000000).nodeCount <= 1.05 * double(box.nodes.size() / 4));
    CHECK(latticeOf(box, 4).nodeCount == 4);
    for (double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
        TetMesh broken = box;
        broken.nodes[5].y = wrong;
        CHECK(isEmpty(latticeOf(broken, 30)));
    }
}

TEST_CASE("fragments around a body are listed one by one, then get one coarse node each, and the last ones none")
{
    TetMesh mesh = boxMesh({12, 12, 12}, {0.1, 0.1, 0.1});
    const std::size_t bodySize = mesh.nodes.size();
    TetMesh fragment = tetrahedronMesh();
    for (Vec3& p : fragment.nodes) p *= 0.001;
    const auto withFragments = [&](TetMesh body, int count) {
        for (int i = 0; i < count; ++i) body = together(std::move(body), fragment, {0.11, 0.002 * i, 0});
        return body;
    };
    const CoarseLattice body = latticeOf(mesh, 100);
    const auto isTold = [](const CoarseLattice& lattice, std::size_t first, int fragments) {
        REQUIRE(lattice.pieces.size() == static_cast<std::size_t>(fragments));
        for (int i = 0; i < fragments; ++i) {
            const int at = static_cast<int>(first) + 4 * i;
            CHECK(lattice.pieces[static_cast<std::size_t>(i)] == std::vector<int>{at, at + 1, at + 2, at + 3});
        }
    };
    const CoarseLattice few = latticeOf(withFragments(mesh, 64), 100);
    isTold(few, bodySize, 64);
    std::vector<bool> taken(few.corners.size());
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] = i < bodySize;
    checkSound(few, taken);
    CHECK(few.nodeCount == body.nodeCount); // the pieces cost the body none of its coarse nodes

    const TetMesh many = withFragments(mesh, 100);
    const CoarseLattice partly = latticeOf(many, 100);
    isTold(partly, bodySize, 64);
    taken.resize(many.nodes.size());
    for (std::size_t i = 0; i < taken.size(); ++i)
        taken[i] = i < bodySize || (i >= bodySize + 64 * 4 && i < bodySize + (64 + 25) * 4);
    checkSound(partly, taken);
    CHECK(partly.nodeCount <= 105);
    CHECK(usedWhere(partly, many, [](Vec3 p) { return p.x > 0.105; }).size() == 25);

    isTold(latticeOf(withFragments({}, 60), 100), 0, 60);
    CHECK(latticeOf(withFragments({}, 60), 100).nodeCount == 0);
    isTold(latticeOf(tetrahedronMesh(), 12), 0, 1);
    CHECK(latticeOf(withFragments({}, 100), 100).nodeCount == 36);
    CHECK(isEmpty(latticeOf(withFragments({}, 400), 100)));
}

TEST_CASE("several bodies in one mesh share the coarse nodes, each with enough to turn and strain")
{
    TetMesh mesh;
    const TetMesh part = boxMesh({3, 3, 3}, {0.01, 0.01, 0.01});
    for (int i = 0; i < 9; ++i) mesh = together(std::move(mesh), part, {0.02 * i, 0.0, 0.001 * i});
    const CoarseLattice lattice = latticeOf(mesh, 40);
    checkSound(lattice);
    CHECK(lattice.nodeCount == 36);
    // If the target allows fewer than four per piece, the larger pieces still get a lattice and the others one coarse
    // node each.
    const CoarseLattice scarce = latticeOf(mesh, 24);
    checkSound(scarce);
    CHECK(scarce.nodeCount <= 25);
    CHECK(scarce.nodeCount >= 18);
}

} // namespace coarse_lattice_test
