#include "effort.h"
#include "verification/verification.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/tissue.h"

/// Tissue under the loads of surgery, as bodies: pressed deep, held, pulled far, and squeezed between plates.
namespace large_strain_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

/// A block of tissue on the ground, 60 x 30 x 60 mm, and a ball of 8 mm radius above its middle: examples/05_poke.
struct Poke {
    static constexpr double kHeight = 0.03, kRadius = 0.008;
    Stage stage;
    BodyId ball;

    explicit Poke(const ElasticLaw& law) : Poke(FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.4, .law = law}) {}
    explicit Poke(const FemMaterial& material)
    {
        stage.add(SoftBodyDef{.name = "tissue",
                              .mesh = shapes::block({0.06, kHeight, 0.06}, {10, 6, 10}),
                              .material = material,
                              .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0149, 1}}}},
                              .collision = {{}}});
        RigidBodyDef def{.name = "ball", .elements = {Pose{place(0.0)}}, .mesh = shapes::sphere(kRadius)};
        def.collision = {{}};
        ball = stage.add(def);
        stage.step(1e-3);
    }

    static Vec3 place(double depth) { return {0, 0.5 * kHeight + kRadius - depth, 0}; }

    /// Presses to a depth [m] in `seconds`, and adds up what steps report.
    void press(double from, double to, double seconds)
    {
        const int steps = static_cast<int>(std::lround(seconds / 1e-3));
        for (int i = 1; i <= steps; ++i) {
            stage.post(SetPose{ball, 0, Pose{place(from + (to - from) * i / steps)}});
            const StepReport report = stage.step(1e-3);
            flags |= report.flags;
            inverted = std::max(inverted, report.inverted.count);
        }
    }
    [[nodiscard]] double force()
    {
        double sum = 0.0;
        for (const frame::Contact& each : stage.world.scene().contactReports) sum += each.normalForce;
        return sum;
    }
    [[nodiscard]] double speed()
    {
        double most = 0.0;
        for (const Vec3& v : stage.soft().v) most = std::max(most, length(v));
        return most;
    }

    std::uint32_t flags = 0;
    int inverted = 0; ///< most elements inside out in a step
};

/// An ellipsoid of tissue with these half axes [m], of 3,072 elements: a cube whose shells become spheres.
std::shared_ptr<const geometry::TetMesh> organ(Vec3 radii)
{
    geometry::TetMesh mesh = *shapes::block({2, 2, 2}, {8, 8, 8});
    for (Vec3& p : mesh.nodes) {
        const double far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        const Vec3 onBall = far > 0.0 ? far / length(p) * p : p;
        p = {radii.x * onBall.x, radii.y * onBall.y, radii.z * onBall.z};
    }
    return shared(std::move(mesh));
}

} // namespace

TEST_CASE("neo-Hookean tissue pressed to 70 % of its depth resists ever more, and at rest no element is inside out")
{
    Poke poke{NeoHookean{}};
    double before = 0.0, at = 0.0, speed = 0.0;
    for (int percent = 10; percent <= 70; percent += 10) {
        const double depth = 0.01 * percent * Poke::kHeight;
        poke.press(at, depth, 0.5);
        poke.press(depth, depth, 1.0);
        at = depth;
        tell(text("ball pressed ", percent, " % deep into neo-Hookean tissue, force [N]"), poke.force());
        CHECK(poke.force() > 1.05 * before);
        CHECK(invertedElements(poke.stage.model(), poke.stage.soft()) == 0);
        before = poke.force();
        speed = std::max(speed, poke.speed());
    }
    // The ball is wider than its surroundings are deep: some elements fold over its rim and turn back.
    CHECK((poke.flags & ~static_cast<std::uint32_t>(StepFlag::Inverted)) == 0);
    tell("ball pressed into neo-Hookean tissue, most elements inside out in a step", poke.inverted);
    verify("ball held for 1 s, largest speed of a node [m/s]", speed, 1e-3);
}

TEST_CASE(
    "tissue of the library and of every law but two resists ever more when it is pressed to 70 % of its depth, or "
    "steps say that elements are inside out",
    "[cases]")
{
    // Elements around the ball turn inside out where shear is many times as stiff as the change of volume.
    const std::string turning[] = {"cartilage", "VerondaWestmann 5", "Fung 10", "Gent 0.4"};
    std::vector<std::pair<std::string, FemMaterial>> all;
    for (const char* name : {"liver", "adipose", "artery_media", "cartilage", "lung"})
        all.emplace_back(name, tissue(name).material); // plain, relaxing, with fibres, and of other Poisson's ratios
    for (const NamedLaw& each : everyLaw())
        if (!std::holds_alternative<Corotational>(each.law) && !std::holds_alternative<StVenantKirchhoff>(each.law))
            all.emplace_back(each.name, FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.4, .law = each.law});
    for (std::size_t i = 0; i < all.size(); i += allCases() ? 1 : 6) {
        const auto& [name, material] = all[i];
        Poke poke{material};
        double before = 0.0, least = 10.0; // [-] by how much a tenth of the depth more raises the force at least
        int percent = 10;
        for (; percent <= 70; percent += 10) {
            const double depth = 0.01 * percent * Poke::kHeight;
            poke.press(depth - 0.1 * Poke::kHeight, depth, 0.2);
            poke.press(depth, depth, 0.2);
            const double force = poke.force();
            REQUIRE(std::isfinite(force));
            if (before > 0.0 && force < 1.05 * before) break;
            if (before > 0.0) least = std::min(least, force / before);
            before = force;
        }
        const bool told = (poke.flags & static_cast<std::uint32_t>(StepFlag::Inverted)) != 0;
        tell("ball pressed into " + name + ", depth up to which the force rises [%]", percent - 10);
        tell("ball pressed into " + name + ", force over E times the square of its radius there",
             before / (material.youngModulus * Poke::kRadius * Poke::kRadius));
        verifyWithin("ball pressed into " + name + ", force over that at a tenth less of the depth, at least", least,
                     1.05, 10.0);
        CHECK((percent > 70 || told));
        if (std::ranges::find(turning, name) == std::end(turning)) CHECK(percent > 70);
    }
}

TEST_CASE("corotational tissue that is pressed too deep is inside out, and steps say so")
{
    Poke poke{Corotational{}};
    poke.press(0.0, 0.5 * Poke::kHeight, 0.5);
    CHECK(poke.inverted > 0);
    CHECK((poke.flags & static_cast<std::uint32_t>(StepFlag::Inverted)) != 0);
}

TEST_CASE("a neo-Hookean strip at 2.5 times its length has the volume of its law")
{
    const double young = 10e3, nu = 0.45, length = 0.05, stretch = 2.5;
    Stage stage;
    const BodyId strip = stage.add(SoftBodyDef{.mesh = shared(boxMesh({12, 3, 3}, {length, 0.01, 0.01})),
                                               .material = FemMaterial{.youngModulus = young, .poissonRatio = nu},
                                               .gravity = false,
                                               .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}}});
    const BodyId clamp = stage.add(RigidBodyDef{.name = "clamp", .elements = {Pose{{length, 0, 0}}}});
    stage.post(Attach{
        AttachmentId{9},
        strip,
        {.box = geometry::Box{{length - 1e-6, -1, -1}, {length + 1e-6, 1, 1}}, .stiffness = kHard, .to = clamp}});
    stage.step(1e-3);
    int inverted = 0;
    for (int i = 1; i <= 1500; ++i) {
        stage.post(SetPose{clamp, 0, Pose{{length * (1 + (stretch - 1) * std::min(i, 1000) / 1000.0), 0, 0}}});
        inverted = std::max(inverted, stage.step(1e-3).inverted.count);
    }
    CHECK(inverted == 0);
    const double rest = meshVolume(stage.model(), stage.model().rest), now = meshVolume(stage.model(), stage.soft().x);
    // Without lateral stress lambda (J - 1) = mu (1/J - 1/s); the clamped ends keep their cross section.
    const double ratio = 2.0 * nu / (1.0 - 2.0 * nu), half = 0.5 * (1.0 - 1.0 / (ratio * stretch));
    const double free = half + std::sqrt(half * half + 1.0 / ratio);
    tell("strip at 2.5 times its length, nu 0.45, volume over that at rest", now / rest);
    tell("the same of the law in free uniaxial tension", free);
    CHECK(now / rest > 1.0);
    CHECK(now / rest < 1.0 + 2.0 * (free - 1.0));
}

TEST_CASE("neo-Hookean tissue that is let go after a deep press returns to its shape")
{
    Poke poke{NeoHookean{}};
    poke.press(0.0, 0.6 * Poke::kHeight, 0.2);
    poke.press(0.6 * Poke::kHeight, -0.01, 0.2);
    poke.press(-0.01, -0.01, 2.0);
    Poke rest{NeoHookean{}};
    rest.press(-0.01, -0.01, 2.0); // it sags under its own weight
    verify("pressed to 60 % and let go, distance from the shape at rest over its height",
           relativeDistance(poke.stage.soft().x, rest.stage.soft().x, Poke::kHeight), 0.01);
}

TEST_CASE("two organs that a plate presses to a third of their height have no element inside out in any step")
{
    Stage stage;
    stage.add(RigidBodyDef{.name = "floor",
                           .elements = {Pose{{0, -0.01, 0}}},
                           .mesh = shapes::box({0.3, 0.02, 0.3}, {12, 1, 12}),
                           .collision = {{}}});
    const auto add = [&](const char* name, Vec3 at, double young) {
        stage.add(SoftBodyDef{.name = name,
                              .mesh = organ({0.03, 0.02, 0.03}),
                              .pose = {at},
                              .material = FemMaterial{.youngModulus = young},
                              .collision = {{}}});
    };
    add("lower organ", {0, 0.0205, 0}, 10e3);
    add("upper organ", {0.001, 0.0612, 0.0005}, 8e3);
    double height = 0.0875; // [m] place of the plate, which sinks until it bears 20 N
    const BodyId plate = stage.add(RigidBodyDef{.name = "plate",
                                                .elements = {Pose{{0, height, 0}}},
                                                .mesh = shapes::box({0.15, 0.01, 0.15}, {6, 1, 6}),
                                                .collision = {{}}});
    stage.post(SetGravity{{0, -9.81, 0}});
    double force = 0.0;
    int inverted = 0;
    for (int i = 0; i < 1500; ++i) {
        inverted = std::max(inverted, stage.step(2e-3).inverted.count);
        force = 0.0;
        for (const frame::Contact& each : stage.world.scene().contactReports)
            if (each.first == plate || each.second == plate) force += each.normalForce;
        height -= 2e-6 * (20.0 - force);
        stage.post(SetPose{plate, 0, Pose{{0, height, 0}}});
    }
    tell("two organs under a plate that is told to bear 20 N, height left of 80 mm [m]", height - 0.005);
    verify("two organs under a plate, most elements inside out in a step", inverted, 0);
    CHECK(height - 0.005 < 0.03);
}

} // namespace large_strain_test
