// The closed forms of contact_test.cpp for bodies that are tied to each other, and for bodies that have been cut.
#include "verification/hertz.h"

namespace joined_contact_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kG = 9.81, kMu = 0.5;
constexpr Vec3 kSize{0.04, 0.02, 0.04}; ///< [m] size of a block

physics::SoftBodyDef block(const std::string& name, std::array<int, 3> cells, Vec3 size, Vec3 corner)
{
    physics::SoftBodyDef def{.name = name, .mesh = shared(boxMesh(cells, size))};
    def.rayleigh.mass = 0.0; // it would brake what slides
    def.pose.position = corner;
    def.collision = {{}};
    def.friction = kMu;
    return def;
}

/// Passes an upright blade once through what is there, along z, with its edge at the height `low`.
void cut(Stage& stage, double x, double low, double reach)
{
    const double high = low + 0.2;
    const physics::TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, low, 0}, {0, low, -0.04}, {0, high, -0.04}, {0, high, 0}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    const auto poseAt = [&](double z) { return Pose{.position = {x, 0.0, z}}; };
    const BodyId blade = stage.add(physics::RigidBodyDef{
        .elements = {poseAt(-reach)}, .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
    for (double z = -reach; z < reach + 0.05; z += 1e-3) {
        stage.post(physics::SetPose{blade, 0, poseAt(z)});
        stage.step(1e-3);
    }
    stage.post(physics::RemoveBody{blade});
    stage.step(0.0);
}

/// The elements that lie above, or below, a height at which the mesh has nodes.
geometry::TetMesh partOf(const geometry::TetMesh& mesh, double height, bool above)
{
    geometry::TetMesh part;
    std::vector<int> number(mesh.nodes.size(), -1);
    for (const geometry::Tetrahedron& each : mesh.tetrahedra) {
        double middle = 0.0;
        for (int node : each) middle += 0.25 * mesh.nodes[static_cast<std::size_t>(node)].y;
        if ((middle > height) != above) continue;
        geometry::Tetrahedron& made = part.tetrahedra.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) {
            int& at = number[static_cast<std::size_t>(each[k])];
            if (at < 0) {
                at = static_cast<int>(part.nodes.size());
                part.nodes.push_back(mesh.nodes[static_cast<std::size_t>(each[k])]);
            }
            made[k] = at;
        }
    }
    return part;
}

/// The highest nodes of a mesh that are lower than this.
double levelBelow(const geometry::TetMesh& mesh, double height)
{
    double level = -1.0;
    for (const Vec3& each : mesh.nodes)
        if (each.y < height) level = std::max(level, each.y);
    return level;
}

/// A stack of two blocks, or a block that was cut, just above the floor at y = 0.
enum class Kind { TiedHard, TiedBySprings, Slit, CutInTwo };
constexpr std::array kKinds{Kind::TiedHard, Kind::TiedBySprings, Kind::Slit, Kind::CutInTwo};

std::string nameOf(Kind kind)
{
    constexpr std::array names{"two blocks tied hard", "two blocks tied by 50 N/m", "a block with a slit",
                               "a block cut in two"};
    return names.at(static_cast<std::size_t>(kind));
}

void addBlocks(Stage& stage, Kind kind)
{
    constexpr double kAbove = 4e-4; // [m]
    if (kind == Kind::TiedHard || kind == Kind::TiedBySprings) {
        const BodyId lower = stage.add(block("lower", {6, 3, 6}, kSize, {-0.02, kAbove, -0.02}));
        physics::SoftBodyDef upper = block("upper", {5, 3, 5}, kSize, {-0.02, kAbove + kSize.y, -0.02});
        upper.attachments = {
            {.within = 1e-3, .stiffness = kind == Kind::TiedHard ? physics::kHard : 50.0, .to = lower}};
        stage.add(upper);
        return;
    }
    physics::SoftBodyDef whole = block("block", {6, 5, 6}, {0.04, 0.03, 0.04}, {-0.02, kAbove, -0.02});
    whole.dynamicTopology = true;
    stage.add(whole);
    cut(stage, 1e-3, kind == Kind::Slit ? 0.015 : -0.01, 0.05);
}

double massOf(Stage& stage)
{
    double sum = 0.0;
    for (std::size_t b = 0; b < stage.world.scene().soft.size(); ++b)
        for (double mass : stage.model(b).masses) sum += mass;
    return sum;
}

BodyId addFloor(Stage& stage)
{
    physics::RigidBodyDef floor{.name = "floor", .elements = {{{0, -0.05, 0}, {}}}};
    floor.mesh = geometry::shapes::box({4.0, 0.1, 1.0});
    floor.friction = kMu;
    floor.collision = {{}};
    return stage.add(floor);
}

/// The velocity of the centre of all mass.
Vec3 velocityOf(Stage& stage)
{
    Vec3 sum;
    for (std::size_t b = 0; b < stage.world.scene().soft.size(); ++b)
        for (std::size_t i = 0; i < stage.model(b).masses.size(); ++i)
            sum += stage.model(b).masses[i] * stage.soft(b).v[i];
    return 1.0 / massOf(stage) * sum;
}

} // namespace

TEST_CASE("bodies that are tied, or cut, press on a floor with their weight")
{
    for (const Kind kind : kKinds) {
        Stage stage;
        addBlocks(stage, kind);
        const BodyId floor = addFloor(stage);
        stage.post(physics::SetGravity{{0, -kG, 0}});
        stage.run(1000, 1e-3);
        Vec3 mean;
        for (int i = 0; i < 200; ++i) {
            stage.step(1e-3);
            mean -= 1.0 / 200 * frame::forceOn(floor, stage.world.scene().contactReports);
        }
        const double weight = massOf(stage) * kG;
        verify(text(nameOf(kind), " at rest: mean contact force over the weight, minus one"),
               length(mean - Vec3{0, weight, 0}) / weight, 0.01);
    }
}

TEST_CASE("bodies that are tied, or cut, slide if the slope exceeds the friction, and only then")
{
    for (const Kind kind : kKinds)
        for (const double tangent : {0.49, 0.51}) {
            Stage stage;
            addBlocks(stage, kind);
            addFloor(stage);
            const double angle = std::atan(tangent);
            stage.post(physics::SetGravity{kG * Vec3{std::sin(angle), -std::cos(angle), 0.0}});
            stage.run(1000, 1e-3);
            const Vec3 before = velocityOf(stage);
            Vec3 moved;
            for (int i = 0; i < 500; ++i) {
                stage.step(1e-3);
                moved += 1e-3 * velocityOf(stage);
            }
            const double gained = (velocityOf(stage) - before).x / 0.5;
            const double expected = kG * (std::sin(angle) - kMu * std::cos(angle));
            const std::string name = text(nameOf(kind), " on a slope of tangent ", tangent, ", mu 0.5: ");
            if (tangent < kMu)
                verify(name + "moved in 0.5 s [m]", length(moved), 1e-5);
            else
                verify(name + "acceleration over theory, minus one", std::abs(gained / expected - 1.0), 0.02);
        }
}

TEST_CASE("a ball pressed into a block of two tied halves feels the force of Hertz")
{
    verifyHertz("ball pressed into a block of two halves that are tied 1 cm below",
                [](Stage& stage, const geometry::TetMesh& mesh) {
                    const double level = levelBelow(mesh, -0.01);
                    const BodyId lower = stage.add(hertzBlock(partOf(mesh, level, false)));
                    physics::SoftBodyDef upper = hertzBlock(partOf(mesh, level, true));
                    upper.attachments = {{.within = 1e-6, .to = lower}};
                    stage.add(upper);
                });
}

TEST_CASE("a ball pressed into a block that was cut feels the force of Hertz")
{
    verifyHertz("ball pressed into a block that is cut through 5 cm beside",
                [](Stage& stage, const geometry::TetMesh& mesh) {
                    physics::SoftBodyDef def = hertzBlock(mesh);
                    def.dynamicTopology = true;
                    stage.add(def);
                    cut(stage, 0.0501, -0.09, 0.12);
                    CHECK(stage.model().rest.size() > mesh.nodes.size());
                });
}

} // namespace joined_contact_test
