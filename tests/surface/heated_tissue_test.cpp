#include "filasofia/surface/heated_tissue.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/surface/burning.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

namespace heated_tissue_test {
using namespace filasofia;
using namespace filasofia::surface;

namespace {

/// The surface of a mesh, with its nodes as vertices.
struct Skin {
    std::shared_ptr<const geometry::TetMesh> mesh;
    std::vector<geometry::Triangle> triangles;
    std::vector<int> nodes;
    std::vector<double> intact;
    explicit Skin(std::shared_ptr<const geometry::TetMesh> of)
        : mesh(std::move(of)), nodes(mesh->nodes.size()), intact(mesh->nodes.size(), 1.0)
    {
        std::iota(nodes.begin(), nodes.end(), 0);
        const geometry::Surface surface = geometry::extractSurface(*mesh);
        triangles = surface.mesh.triangles;
        for (geometry::Triangle& each : triangles)
            for (int& corner : each) corner = surface.nodes[static_cast<std::size_t>(corner)];
    }
    std::vector<HeatedPart> spread(HeatedTissue& tissue) const
    {
        return tissue.spread(triangles, nodes, mesh->nodes, intact);
    }
    [[nodiscard]] double volume(int tetrahedron) const
    {
        const auto& [a, b, c, d] = mesh->tetrahedra[static_cast<std::size_t>(tetrahedron)];
        const std::vector<Vec3>& x = mesh->nodes;
        return dot(cross(x[b] - x[a], x[c] - x[a]), x[d] - x[a]) / 6.0;
    }
    [[nodiscard]] double volumeOf(const std::vector<HeatedPart>& parts) const
    {
        double sum = 0.0;
        for (const HeatedPart& part : parts)
            for (const int each : part.tetrahedra) sum += part.share * volume(each);
        return sum;
    }
};

BurningDef still(double temperature)
{
    return {.perfusion = 0.0, .loss = 0.0, .temperature = temperature, .tissue = HeatedTissueDef{}};
}

} // namespace

TEST_CASE("what is denatured below a hot side is a layer of the told depth, whatever the tetrahedra")
{
    for (const int layers : {2, 5, 12})
        for (const double depth : {1e-3, 2.5e-3}) {
            Skin skin(geometry::shapes::block({0.02, 0.01, 0.02}, {10, layers, 10}));
            HeatedTissue tissue(skin.mesh, depth);
            CHECK(skin.spread(tissue).empty());
            for (std::size_t v = 0; v < skin.intact.size(); ++v)
                if (skin.mesh->nodes[v].y > 0.0049) skin.intact[v] = 0.0;
            std::erase_if(skin.triangles, [&](const geometry::Triangle& t) { // the other sides are cold
                return std::ranges::any_of(t, [&](int node) { return skin.mesh->nodes[node].y < 0.0049; });
            });
            const double bound = 0.01 / layers > 4.0 * depth ? 0.3 : 0.12; // so large tetrahedra have too few samples
            INFO(layers << " layers, depth " << depth);
            CHECK(skin.volumeOf(skin.spread(tissue)) == Approx(0.02 * 0.02 * depth).epsilon(bound));
            CHECK(skin.spread(tissue).empty()); // told once
        }
}

TEST_CASE("tissue goes through a few levels, each told once, and ends with all of it")
{
    Skin skin(geometry::shapes::block({0.01, 0.002, 0.01}, {5, 1, 5}));
    HeatedTissue tissue(skin.mesh, 0.002);
    double last = 0.0;
    int told = 0;
    for (int i = 1; i <= 100; ++i) {
        std::ranges::fill(skin.intact, 1.0 - 0.01 * i);
        const std::vector<HeatedPart> parts = skin.spread(tissue);
        if (parts.empty()) continue;
        REQUIRE(parts.size() == 1);
        CHECK(parts[0].tetrahedra.size() == skin.mesh->tetrahedra.size());
        CHECK(parts[0].share > last);
        CHECK(parts[0].share == Approx(0.01 * i).margin(0.07));
        last = parts[0].share;
        ++told;
    }
    CHECK(last == 1.0);
    CHECK(told == 8);
}

TEST_CASE("heat does not reach what lies in front of a surface")
{
    // Two blocks with a gap of half a millimetre; the upper side of the lower one is hot.
    geometry::TetMesh mesh = *geometry::shapes::block({0.01, 0.004, 0.01}, {5, 4, 5});
    const geometry::TetMesh lower = mesh;
    for (const Vec3& each : lower.nodes) mesh.nodes.push_back(each + Vec3{0, 0.0045, 0});
    const int count = static_cast<int>(lower.nodes.size());
    for (geometry::Tetrahedron each : lower.tetrahedra) {
        for (int& node : each) node += count;
        mesh.tetrahedra.push_back(each);
    }
    Skin skin(std::make_shared<const geometry::TetMesh>(mesh));
    for (std::size_t v = 0; v < lower.nodes.size(); ++v)
        if (lower.nodes[v].y > 0.0019) skin.intact[v] = 0.0;
    HeatedTissue tissue(skin.mesh, 0.002);
    const std::vector<HeatedPart> parts = skin.spread(tissue);
    CHECK(skin.volumeOf(parts) == Approx(0.01 * 0.01 * 0.002).epsilon(0.1));
    for (const HeatedPart& part : parts)
        for (const int each : part.tetrahedra) CHECK(each < static_cast<int>(lower.tetrahedra.size()));
}

TEST_CASE("collagen denatures as Arrhenius' law says: not within an hour at 37 degrees, within seconds at 65")
{
    const Skin skin(geometry::shapes::block({0.01, 0.002, 0.01}, {5, 1, 5}));
    const auto after = [&](double temperature, double seconds) {
        Burning heat(still(temperature), skin.triangles, "block", skin.mesh);
        for (int i = 0; i < std::lround(seconds * 60.0); ++i) heat.step(skin.mesh->nodes, {}, 1.0 / 60.0);
        const std::vector<HeatedPart> parts = heat.takeParts();
        CHECK(parts.empty() == (heat.denatured(0) < 0.07));
        return heat.denatured(0);
    };
    const HeatedTissueDef def;
    const auto rate = [&](double t) { return def.frequencyFactor * std::exp(-def.activationEnergy / (8.31446 * t)); };
    CHECK(3600.0 * rate(310.15) < 0.01);
    CHECK(after(317.15, 60.0) == Approx(1.0 - std::exp(-60.0 * rate(317.15))).epsilon(1e-3));
    for (const double temperature : {330.15, 338.15, 343.15})
        CHECK(after(temperature, 5.0) == Approx(1.0 - std::exp(-5.0 * rate(temperature))).epsilon(1e-4));
    CHECK(after(338.15, 10.0) == Approx(0.63).margin(0.05));
    CHECK(after(348.15, 1.0) > 0.98);
}

TEST_CASE("heat that acts on tissue needs tetrahedra and legal numbers")
{
    const Skin skin(geometry::shapes::block({0.01, 0.002, 0.01}, {5, 1, 5}));
    CHECK_THROWS_WITH(Burning(still(310.0), skin.triangles, "x"), "x: tissue needs a body of tetrahedra");
    BurningDef def = still(310.0);
    def.tissue->shrinkage = 0.6;
    CHECK_THROWS_WITH(Burning(def, skin.triangles, "x", skin.mesh), "x: tissue.shrinkage must be in [0, 0.5], got 0.6");
}

} // namespace heated_tissue_test
