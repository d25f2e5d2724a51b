#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/fem_material.h"

#include "geometry/sample_meshes.h"

namespace tissue_region_test {

using namespace filasofia;
using namespace filasofia::physics;
using Catch::Matchers::Contains;
using geometry::errorOf;
namespace shapes = filasofia::geometry::shapes;

namespace {

Vec3 centreOf(const geometry::TetMesh& mesh, int t)
{
    Vec3 sum;
    for (int node : mesh.tetrahedra[static_cast<std::size_t>(t)])
        sum += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
    return sum;
}

/// A block with label 4 below z = 0, named "muscle", and 9 above.
geometry::TetMesh labelled()
{
    geometry::TetMesh mesh = *shapes::block({0.04, 0.04, 0.04}, {4, 4, 4});
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        mesh.labels.push_back(centreOf(mesh, t).z < 0.0 ? 4 : 9);
    mesh.labelNames = {{4, "muscle"}};
    return mesh;
}

/// Checks the tetrahedra of a region one by one.
template <class IsIn> void checkRegion(const RegionShape& where, const IsIn& isIn)
{
    const geometry::TetMesh mesh = labelled();
    std::vector<int> expected;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        if (isIn(mesh, t)) expected.push_back(t);
    CHECK(tetrahedraOf(where, mesh, "here") == expected);
    CHECK(!expected.empty());
    CHECK(expected.size() < mesh.tetrahedra.size());
}

std::string errorOfRegion(const RegionShape& where, const geometry::TetMesh& mesh)
{
    return errorOf([&] { tetrahedraOf(where, mesh, "region"); });
}

} // namespace

TEST_CASE("a region has the tetrahedra that its shape says, and no others")
{
    checkRegion(Labelled{.label = 9}, [](const auto& mesh, int t) { return mesh.labels[t] == 9; });
    checkRegion(Labelled{.name = "muscle"}, [](const auto& mesh, int t) { return mesh.labels[t] == 4; });
    checkRegion(geometry::Box{{0, -1, -1}, {1, 1, 1}},
                [](const auto& mesh, int t) { return centreOf(mesh, t).x >= 0; });
    checkRegion(Ball{.centre = {0.01, 0, 0}, .radius = 0.012}, [](const auto& mesh, int t) {
        return distance(centreOf(mesh, t), {0.01, 0, 0}) <= 0.012;
    });
    checkRegion(NearSurface{.depth = 4e-3}, [](const auto& mesh, int t) {
        const Vec3 c = centreOf(mesh, t);
        return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) >= 0.016;
    });
    checkRegion(AtInterface{.first = {.label = 4}, .second = {.label = 9}}, [](const auto& mesh, int t) {
        for (int node : mesh.tetrahedra[t])
            if (std::abs(mesh.nodes[node].z) < 1e-9) return true;
        return false;
    });
    checkRegion(Listed{.tetrahedra = {7, 3, 3}}, [](const auto&, int t) { return t == 3 || t == 7; });
}

TEST_CASE("a region that does not fit its mesh is one clear error")
{
    const geometry::TetMesh mesh = labelled();
    CHECK_THAT(errorOfRegion(Labelled{.name = "bone"}, mesh),
               Contains("region: the mesh has no label named 'bone'; its names: 'muscle'"));
    CHECK_THAT(errorOfRegion(Labelled{.label = 5}, mesh), Contains("region: must contain at least one tetrahedron"));
    CHECK_THAT(errorOfRegion(Labelled{}, *shapes::block({1, 1, 1}, {1, 1, 1})), Contains("the mesh must have labels"));
    CHECK_THAT(errorOfRegion(Listed{.tetrahedra = {400}}, mesh), Contains("tetrahedra must be in [0, 384), got 400"));
    CHECK_THAT(errorOfRegion(geometry::Box{{1, 1, 1}, {0, 0, 0}}, mesh), Contains("high must be >= low"));
    CHECK_THAT(errorOfRegion(Ball{.centre = {9, 9, 9}}, mesh), Contains("got none"));
}

TEST_CASE("fibres run as their direction says")
{
    const geometry::TetMesh mesh = labelled();
    const auto directions = [&](FibreFamily family) { return directionsOf(family, mesh, "fibres[0]"); };
    for (const Vec3 d : directions({.direction = Along{{0, 3, 0}}})) CHECK(d == Vec3{0, 1, 0});
    const std::vector<Vec3> around = directions({.direction = Around{.pitch = 0.3}});
    for (int t = 0; t < static_cast<int>(around.size()); ++t) {
        const Vec3 d = around[static_cast<std::size_t>(t)], c = centreOf(mesh, t);
        CHECK(std::abs(length(d) - 1.0) < 1e-12);
        CHECK(std::abs(d.z - std::sin(0.3)) < 1e-12);
        CHECK(std::abs(d.x * c.x + d.y * c.y) < 1e-12);
    }
    // Between two opposite layers the harmonic function is linear.
    FibreFamily harmonic{.direction = HarmonicField{.from = geometry::Box{{-1, -1, -1}, {-0.01, 1, 1}},
                                                    .to = geometry::Box{{0.01, -1, -1}, {1, 1, 1}}}};
    int counted = 0;
    for (const Vec3 d : directions(harmonic)) {
        if (d == Vec3{}) continue;
        CHECK(std::abs(d.x - 1.0) < 1e-9);
        ++counted;
    }
    CHECK(counted == 192);
    // Only where the family is.
    harmonic = {.direction = Along{}, .where = Labelled{.label = 4}};
    const std::vector<Vec3> some = directions(harmonic);
    for (std::size_t t = 0; t < some.size(); ++t) CHECK((some[t] != Vec3{}) == (mesh.labels[t] == 4));
}

TEST_CASE("fibres without a direction are one clear error")
{
    const geometry::TetMesh mesh = labelled();
    const auto error = [&](FibreFamily family) { return errorOf([&] { directionsOf(family, mesh, "fibres[0]"); }); };
    CHECK_THAT(error({.direction = Along{{0, 0, 0}}}), Contains("fibres[0].direction.direction must have a length"));
    CHECK_THAT(error({.direction = DirectionField{{{1, 0, 0}}}}), Contains("one entry per tetrahedron (384), got 1"));
    CHECK_THAT(error({.direction = DirectionField{std::vector<Vec3>(384)}}), Contains("in at least one tetrahedron"));
    CHECK_THAT(error({.direction = HarmonicField{Labelled{.label = 4}, Labelled{.label = 9}}}),
               Contains("must have no node in common"));
}

TEST_CASE("a material says what is wrong with its lists")
{
    const auto error = [](const FemMaterial& material) { return errorOf([&] { check(material, "it"); }); };
    CHECK_THAT(error({.relaxation = {{.share = 0.6}, {.share = 0.4}}}), Contains("must add up to less than 1, got 1"));
    CHECK_THAT(error({.relaxation = std::vector<PronyTerm>(5, {.share = 0.1})}), Contains("at most 4 entries, got 5"));
    CHECK_THAT(error({.fibres = std::vector<FibreFamily>(5)}), Contains("at most 4 entries, got 5"));
    const geometry::TetMesh mesh = labelled();
    CHECK_THAT(errorOf([&] { check(FemMaterial{.stiffnessField = {1.0}}, mesh, "it"); }),
               Contains("it.stiffnessField must have one entry per tetrahedron (384), got 1"));
    FemMaterial named{.regions = {{.where = Labelled{.name = "muscle"}}}};
    resolveNames(mesh, "it", named);
    CHECK(std::get<Labelled>(named.regions[0].where) == Labelled{.name = "", .label = 4});
}

TEST_CASE("every law has the name of its type")
{
    CHECK(nameOf(NeoHookean{}) == "NeoHookean");
    CHECK(nameOf(Ogden{}) == "Ogden");
}

TEST_CASE("every law is legal with its defaults, and a number outside of its range is refused by name")
{
    int numbers = 0;
    for (const ElasticLaw& law : elasticLaws()) {
        INFO(nameOf(law));
        FemMaterial material{.law = law};
        CHECK_NOTHROW(validate(material, "organ"));
        CHECK_NOTHROW(check(material, "organ"));
        std::visit(
            [&]<class Law>(Law& each) {
                forEachField<Law>([&](const auto& field) {
                    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(each.*(field.member))>, double>) {
                        const double legal = each.*(field.member);
                        for (const double wrong : {field.range.low - 0.01, field.range.high + 0.01}) {
                            each.*(field.member) = wrong;
                            CHECK(errorOf([&] { validate(material, "organ"); }) ==
                                  text("organ: law.", field.name, " ", field.range.text(field.unit), ", got ", wrong));
                            ++numbers;
                        }
                        each.*(field.member) = legal;
                    }
                });
            },
            material.law);
    }
    CHECK(numbers >= 8); // MooneyRivlin, VerondaWestmann, Fung and Gent have them
}

} // namespace tissue_region_test
