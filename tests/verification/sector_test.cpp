#include "filasofia/engine/body/elements.h"

#include "verification/verification.h"

#include "effort.h"
#include "engine/elastic/laws.h"

#include <functional>
#include <numbers>

/// A thick tube that is inflated and a block that is bent into a quarter of a ring, in plane strain, with every law.
/// Both keep their planes of symmetry, so that meshes are regular and a quarter is enough, and both have a radial
/// equation of equilibrium that needs no mesh. Three meshes give the order and the limit (Richardson 1911).
namespace sector_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kYoung = 10e3, kNu = 0.3, kThick = 0.01, kInner = 0.01; // [Pa] [-] [m] [m]
constexpr double kQuarter = 0.5 * std::numbers::pi;

/// A sector of a ring: a point at the depth X in [0, kThick] moves to the radius r(X) and has the hoop stretch r g(X).
struct Sector {
    bool bent = false;      ///< a block, which the deformation makes a ring; if not, a tube
    double curvature = 0.0; ///< [1/m] bent: angle per length
    double stretch = 1.0;   ///< [-] tube: that of its inner surface

    [[nodiscard]] double hoopOf(double depth) const { return bent ? curvature : 1.0 / (kInner + depth); }
    /// Where the point at this depth and part of the quarter is at rest.
    [[nodiscard]] Vec3 rest(double depth, double part, double z) const
    {
        if (bent) return {depth, part * kQuarter / curvature, z};
        const double r = kInner + depth;
        return {r * std::cos(part * kQuarter), r * std::sin(part * kQuarter), z};
    }
};

/// The solution over the depth, and what holds it.
struct Profile {
    std::vector<double> radii; ///< [m] at depths with equal distances
    double load =
        0.0; ///< tube: [Pa] pressure on the present inner surface; bent: [N] moment over width, about the axis
};

double along(const std::vector<double>& radii, double depth)
{
    const double at = depth / kThick * static_cast<double>(radii.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(at), radii.size() - 2);
    const double t = at - static_cast<double>(k);
    return (1 - t) * radii[k] + t * radii[k + 1];
}

/// dP_r/dX = g (P_t - P_r) of a tube, g P_t of a block, by shooting for what is unknown at the inner surface: the
/// radial stress of a tube, the radius of a block. Runge-Kutta of order 4.
Profile solved(const Sector& sector, const ElasticLaw& law)
{
    const Lame material = lame(kYoung, kNu);
    const auto stresses = [&](double radial, double hoop) {
        const Mat3 p = stressAt(law, material, {Mat3::diagonal({radial, hoop, 1.0}), Mat3::identity()});
        return std::array{p[0].x, p[1].y};
    };
    // The radial stretch at which the radial stress is this. St Venant-Kirchhoff's law softens below 0.58.
    const double least = std::holds_alternative<StVenantKirchhoff>(law) ? 0.59 : 0.15;
    const auto radialOf = [&](double stress, double hoop) {
        double low = least, high = 3.0;
        for (int k = 0; k < 45; ++k) {
            const double middle = 0.5 * (low + high);
            (stresses(middle, hoop)[0] < stress ? low : high) = middle;
        }
        return 0.5 * (low + high);
    };
    struct Point {
        double radius = 0.0, stress = 0.0, moment = 0.0;
    };
    const auto slope = [&](double depth, const Point& p) {
        const double g = sector.hoopOf(depth), radial = radialOf(p.stress, p.radius * g);
        const auto [pr, pt] = stresses(radial, p.radius * g);
        return Point{radial, g * (pt - (sector.bent ? 0.0 : pr)), p.radius * pt};
    };
    constexpr int kSteps = 32;
    std::vector<double> radii;
    const auto outside = [&](Point p) {
        radii = {p.radius};
        const double h = kThick / kSteps;
        for (int i = 0; i < kSteps; ++i) {
            const auto moved = [&](const Point& d, double by) {
                return Point{p.radius + by * d.radius, p.stress + by * d.stress, p.moment + by * d.moment};
            };
            const Point a = slope(i * h, p), b = slope((i + 0.5) * h, moved(a, 0.5 * h));
            const Point c = slope((i + 0.5) * h, moved(b, 0.5 * h)), d = slope((i + 1) * h, moved(c, h));
            p = moved(a, h / 6), p = moved(b, h / 3), p = moved(c, h / 3), p = moved(d, h / 6);
            radii.push_back(p.radius);
        }
        return p;
    };
    const auto start = [&](double unknown) {
        return sector.bent ? Point{unknown, 0.0} : Point{sector.stretch * kInner, unknown};
    };
    double low = sector.bent ? 1.0 / sector.curvature - kThick : -10.0 * kYoung;
    double high = sector.bent ? 1.0 / sector.curvature : 0.0;
    Point end;
    for (int k = 0; k < 45; ++k) {
        const double middle = 0.5 * (low + high);
        end = outside(start(middle));
        (end.stress < 0.0 ? low : high) = middle;
    }
    return {radii, sector.bent ? end.moment : -low / sector.stretch};
}

/// Single components of nodes that stay where they are.
using Held = std::vector<std::array<bool, 3>>;

/// Newton's method with the step's tangent; what is held leaves the unknowns by rows and columns of the identity.
void solveHeld(const SoftModel& model, const Held& held, std::vector<Vec3>& x)
{
    SoftModel still = model;
    still.integrator = ImplicitEuler{};
    still.solver = Cholesky{};
    still.rayleigh = {.mass = 0.0, .stiffness = 0.0};
    AssembledSystem system(still);
    SoftState state = stateAtStart(still);
    state.x = x;
    const std::vector<Vec3> loads(x.size());
    std::vector<Vec3> dx(x.size());
    for (int iteration = 0; iteration < 100; ++iteration) {
        assembleMatrix(still, loads, 1.0, 0.0, state, system);
        linalg::BlockSparseMatrix& matrix = system.matrix;
        for (int r = 0; r < matrix.rows(); ++r)
            for (int p = matrix.rowStarts()[r]; p < matrix.rowStarts()[r + 1]; ++p)
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        if (const int c = matrix.columns()[p]; held[r][i] || held[c][j])
                            matrix.block(p)[i][j] = r == c && i == j ? kYoung * kThick : 0.0;
        for (std::size_t r = 0; r < x.size(); ++r)
            for (int i = 0; i < 3; ++i)
                if (held[r][i]) system.rightHandSide[r][i] = 0.0;
        system.solver->solve(matrix, system.rightHandSide, dx);
        double most = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) state.x[i] += dx[i], most = std::max(most, length(dx[i]));
        if (most < 1e-6 * kThick) break; // linear, by a factor of 0.6
    }
    x = state.x;
}

/// The load that holds a mesh of so many cells through the thickness, twice as many along the quarter and one across.
double meshLoad(const Sector& sector, const ElasticLaw& law, const Profile& start, int cells)
{
    const double width = kThick / cells;
    const geometry::TetMesh grid = boxMesh({cells, 2 * cells, 1}, {kThick, 1.0, width});
    geometry::TetMesh mesh = grid;
    for (Vec3& p : mesh.nodes) p = sector.rest(p.x, p.y, p.z);
    SoftBodyDef def = freeBody(mesh);
    def.material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu, .law = law};
    def.solver = Cholesky{};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    const SoftModel& model = stage.model();
    std::vector<Vec3> x;
    Held held;
    for (const Vec3& p : grid.nodes) {
        const double r = along(start.radii, p.x), angle = p.y * kQuarter;
        x.push_back({p.y == 1.0 ? 0.0 : r * std::cos(angle), p.y == 0.0 ? 0.0 : r * std::sin(angle), p.z});
        const bool inner = !sector.bent && p.x == 0.0;
        held.push_back({inner || p.y == 1.0, inner || p.y == 0.0, true});
    }
    solveHeld(model, held, x);
    double load = 0.0; // what turns the end, or pushes the inner surface out
    for (const FemElement& e : model.elements) {
        const Corners corners = cornersOf(e.nodes, x);
        const Corners pull = forcesOf(law, e, corners);
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 at = grid.nodes[static_cast<std::size_t>(e.nodes[k])];
            if (sector.bent && at.y == 1.0) load -= cross(corners[k], pull[k]).z / width;
            if (!sector.bent && at.x == 0.0)
                load -= dot(pull[k], normalized(Vec3{corners[k].x, corners[k].y, 0.0})) /
                        (kQuarter * sector.stretch * kInner * width);
        }
    }
    return load;
}

/// With 1, 2 and 4 times as many cells.
void compare(const std::string& what, const Sector& sector, const ElasticLaw& law, int cells)
{
    const Profile exact = solved(sector, law);
    std::array<double, 3> errors{};
    for (std::size_t k = 0; k < 3; ++k) errors[k] = meshLoad(sector, law, exact, cells << k) / exact.load - 1.0;
    const auto [a, b, c] = errors;
    const double first = b + (b - a) / 3.0, second = c + (c - b) / 3.0;
    tell(text(what, ", ", 4 * cells, " cells, load over that of the radial equation, less one"), c);
    tell(text(what, ", extrapolated from the last two"), second);
    verifyWithin(text(what, ", order"), std::log2((a - b) / (b - c)), 1.7, 2.2);
    verify(text(what, ", extrapolated from three meshes, relative error"), std::abs(second + (second - first) / 15.0),
           1e-3);
}

/// How far the tube is inflated. St Venant-Kirchhoff's law softens in its wall beyond that, and laws that stiffen fast
/// have a layer at the inner surface that 8 cells do not resolve.
double stretchOf(const std::string& name)
{
    if (name == "StVenantKirchhoff") return 1.2;
    if (name == "Fung 10" || name == "Gent 0.4") return 1.3;
    return name == "VerondaWestmann 5" ? 1.5 : 2.0;
}

/// [-] The angle by which the block is bent over its thickness as length, for the same reasons.
double curvatureOf(const std::string& name)
{
    const bool limited = name == "StVenantKirchhoff" || name == "VerondaWestmann 5";
    return limited || name == "Fung 10" || name == "Gent 0.4" ? 0.4 : 0.7;
}

} // namespace

TEST_CASE("sector: the pressure that inflates a thick tube is that of the radial equation, with every law")
{
    for (const auto& [name, law] : everyLaw()) {
        const double stretch = stretchOf(name);
        compare(text("thick tube, inner radius ", stretch, " times, ", name), {.stretch = stretch}, law, 2);
    }
}

TEST_CASE("sector: the moment that bends a block into a ring is that of the radial equation, with every law", "[cases]")
{
    for (const auto& [name, law] : everyLaw())
        if (allCases() || name == "NeoHookean" || name == "Fung")
            compare(text("block bent by ", curvatureOf(name), " over its thickness, ", name),
                    {.bent = true, .curvature = curvatureOf(name) / kThick}, law, 4);
}

} // namespace sector_test
