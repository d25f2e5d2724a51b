#include "filasofia/testing/fuzz_law_scene.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/fuzz_blade.h"
#include "filasofia/testing/fuzz_law_tissue.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::testing {
using namespace physics;
namespace {

namespace shapes = geometry::shapes;
using Bodies = std::vector<BodyId>;

constexpr double kGap = 1e-3;                         ///< [m] between bodies at the start
constexpr double kStride = 0.05, kBladeStride = 0.15; ///< [-] the longest way of a tool in a step, over the body's size
constexpr double kLargeChance = 0.01;                 ///< [-] for a body that several threads share

class LawSceneMaker {
public:
    LawSceneMaker(std::size_t kind, FuzzRandom& random, LawFuzzKind& counts, LawFuzzReport& report)
        : kind_(kind), random_(random), counts_(counts), report_(report)
    {
        constexpr std::array rates{100.0, 250.0, 500.0, 1000.0, 1000.0, 2000.0, 4000.0}; // [1/s]
        scene_.period = 1.0 / rates[static_cast<std::size_t>(random.below(rates.size()))];
        size_ = random.logarithmic(0.01, 0.05);
        friction_ = random.uniform(0.0, 1.0);
        scene_.bodies.emplace_back(rigid("floor", shapes::box({4, 0.2, 4}), {{0, -0.1, 0}}));
    }

    LawScene make()
    {
        addTissue(random_.chance(kLargeChance));
        if (random_.chance(0.1)) addTissue(false);
        wait(3 + random_.below(7));
        const int acts = 2 + random_.below(3);
        for (int i = 0; i < acts; ++i) act();
        scene_.acting = steps_;
        scene_.calm = 30 + random_.below(20);
        return std::move(scene_);
    }

private:
    [[nodiscard]] double now() const { return steps_ * scene_.period; }
    void wait(int steps) { steps_ += steps; }

    RigidBodyDef rigid(const char* name, const std::shared_ptr<const geometry::TriangleMesh>& mesh,
                       const Pose& at) const
    {
        RigidBodyDef def{.name = name, .elements = {at}, .mesh = mesh};
        def.collision = {{}};
        def.friction = friction_;
        return def;
    }

    SoftMeshSource tetrahedra(bool large, Vec3 size)
    {
        if (large) return shapes::block(size, {8, 6, 8});
        switch (random_.below(3)) {
        case 0:
            return shapes::block(size, {3 + random_.below(3), 2 + random_.below(2), 3 + random_.below(3)});
        case 1:
            return shapes::bladder(0.2 * size, 0.25 * size_, {3, 1 + random_.below(2)});
        default: {
            std::vector<Vec3> line;
            for (int i = 0; i <= 6; ++i) line.push_back({size.x * (i / 6.0 - 0.5), 0, 0});
            return shapes::vessel(line, 0.2 * size.y, 0.3 * size.y, {8, 1});
        }
        }
    }
    SoftMeshSource triangles(bool large, Vec3 size)
    {
        const int cells = large ? 34 : 7 + random_.below(5);
        if (large || random_.chance(0.5)) return shapes::sheet(size.x, size.z, {cells, cells});
        if (random_.chance(0.5)) return shapes::sphere(0.5 * size.y, 4);
        return shapes::cylinder(0.4 * size.y, size.y, 3);
    }

    /// A soft body that lies just above all others, or hangs there if its nodes at one end are pinned.
    void addTissue(bool large)
    {
        const Vec3 size{size_ * random_.uniform(0.7, 1.4), size_ * random_.uniform(0.5, 1.0),
                        size_ * random_.uniform(0.7, 1.4)};
        SoftBodyDef def{.name = "tissue " + std::to_string(scene_.bodies.size())};
        const bool shell = kind_ + 1 == kLawKinds;
        def.mesh = shell ? triangles(large, size) : tetrahedra(large, size);
        def.pose.position = {0, top_ + kGap + 0.55 * size.y, 0};
        if (shell)
            def.material = randomShell(size_, random_);
        else
            def.material = randomTissue(kind_, size_, random_, report_);
        if (auto* fem = std::get_if<FemMaterial>(&def.material); fem && large) // twenty times the steps' cost beyond it
            fem->poissonRatio = std::min(fem->poissonRatio, 0.45);
        setStrain(def);
        if (const auto* fem = std::get_if<FemMaterial>(&def.material)) {
            scene_.relaxes = scene_.relaxes || !fem->relaxation.empty();
            const bool flows = std::isfinite(fem->yieldStress) || !fem->regions.empty(); // regions may
            scene_.contracts = scene_.contracts || (flows && !fem->fibres.empty());      // a command may contract them
        }
        def.rayleigh = {.mass = random_.uniform(0.0, 5.0), .stiffness = random_.chance(0.5) ? 0.0 : 1e-3};
        def.collision = {{.self = random_.chance(0.1)}};
        def.friction = friction_;
        def.dynamicTopology = true;
        if (random_.chance(0.6)) pin(def, size);
        if (scene_.bodies.size() == kTissue) middle_ = def.pose.position, extent_ = size;
        top_ += kGap + 1.1 * size.y;
        scene_.bodies.emplace_back(std::move(def));
    }
    /// Holds its nodes at one end, or those below.
    void pin(SoftBodyDef& def, Vec3 size)
    {
        const bool below = random_.chance(0.5);
        const auto held = [&](Vec3 p) { return below ? p.y < -0.3 * size.y : p.x < -0.3 * size.x; };
        AttachmentDef pins;
        const auto hold = [&](const std::vector<Vec3>& nodes) {
            for (std::size_t i = 0; i < nodes.size(); ++i)
                if (held(nodes[i])) pins.nodes.push_back(static_cast<int>(i));
        };
        if (const auto* mesh = std::get_if<std::shared_ptr<const geometry::TetMesh>>(&def.mesh)) hold((*mesh)->nodes);
        if (const auto* sheet = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&def.mesh))
            hold((*sheet)->vertices);
        if (!pins.nodes.empty()) def.attachments = {pins};
    }
    /// All bodies of a scene have the same valid strain or none.
    void setStrain(SoftBodyDef& def)
    {
        if (scene_.bodies.size() == kTissue && random_.chance(0.3)) scene_.validStrain = random_.uniform(0.05, 0.5);
        std::visit(
            [&](auto& material) {
                if constexpr (requires { material.validStrain; }) material.validStrain = scene_.validStrain;
            },
            def.material);
    }

    void act()
    {
        switch (random_.below(10)) {
        case 0:
            return press();
        case 1:
        case 2:
            return pull();
        case 3:
            return change();
        default:
            return cut();
        }
    }

    /// [-] A random number of steps for this way [m].
    int stepsFor(double way, double stride)
    {
        return 1 + static_cast<int>(way / (stride * size_ * random_.uniform(0.3, 1.0)));
    }

    /// A tool of this scene that goes from pose to pose from now on; its index in the list of bodies.
    std::size_t tool(RigidBodyDef def, const std::vector<Pose>& way, double stride = kStride)
    {
        const std::size_t body = scene_.bodies.size();
        ToldBody told{.body = body, .keys = {{0.0, way.front()}, {now(), way.front()}}};
        def.elements = {way.front()};
        for (std::size_t i = 1; i < way.size(); ++i) {
            wait(stepsFor(distance(way[i - 1].position, way[i].position), stride));
            told.keys.push_back({now(), way[i]});
        }
        scene_.told.push_back(std::move(told));
        scene_.bodies.emplace_back(std::move(def));
        return body;
    }

    /// A blade goes through the tissue, or into it and back.
    void cut()
    {
        const Vec3 along = random_.direction();
        const Vec3 other = random_.direction();
        const Vec3 across =
            normalized(cross(along, std::abs(dot(along, other)) > 0.9 ? Vec3{along.y, along.z, along.x} : other));
        const Quat turn = frameOf(across, along);
        const Vec3 through = middle_ + 0.3 * size_ * random_.uniform(-1.0, 1.0) * cross(along, across);
        const double before = 1.2 * size_, beyond = size_ * (random_.chance(0.6) ? 1.3 : random_.uniform(-0.4, 0.5));
        const Pose outside{through - before * along, turn};
        std::vector<Pose> way{outside, {through + beyond * along, turn}};
        if (random_.chance(0.3)) way.push_back(outside);
        RigidBodyDef blade{.name = "blade"};
        blade.collision = {{.mesh = bladeOf(size_), .proximity = 0, .cutting = true}};
        tool(blade, way, kBladeStride);
        ++counts_.strokes;
    }

    /// A tool is pushed into the tissue from above, and goes up again; by chance it grasps what it touches.
    void press()
    {
        const double radius = size_ * random_.uniform(0.1, 0.35);
        const double x = 0.3 * extent_.x * random_.uniform(-1.0, 1.0), z = 0.3 * extent_.z * random_.uniform(-1.0, 1.0);
        const double high = top_ + radius + 2 * kGap, deep = high - extent_.y * random_.uniform(0.1, 0.7);
        const std::size_t body =
            tool(rigid("tool",
                       random_.chance(0.5) ? shapes::sphere(radius, 3) : shapes::box({radius, 2 * radius, radius}), {}),
                 {{{x, high, z}}, {{x, deep, z}}});
        ++report_.presses;
        if (random_.chance(0.5)) {
            ++report_.grasps;
            scene_.events.push_back({now(), [body](PhysicsServer& server, const Bodies& bodies) {
                                         server.grasp(bodies[body], bodies[kTissue]);
                                     }});
        }
        wait(5);
        const double up = high + extent_.y * random_.uniform(0.0, 1.0);
        wait(stepsFor(up - deep, kStride));
        scene_.told.back().keys.push_back({now(), {{x, up, z}}});
    }

    /// A hand takes hold of a part of the tissue and draws it away.
    void pull()
    {
        const Vec3 at =
            middle_ + 0.5 * Vec3{extent_.x * random_.uniform(-1.0, 1.0), extent_.y * random_.uniform(0.0, 1.0),
                                 extent_.z * random_.uniform(-1.0, 1.0)};
        const double radius = size_ * random_.uniform(0.25, 0.5), begin = now();
        const Vec3 towards = random_.direction();
        const Vec3 to = at + size_ * random_.uniform(0.2, 1.5) * towards;
        const std::size_t body = tool(RigidBodyDef{.name = "hand"}, {{at}, {to}});
        ++report_.pulls;
        scene_.events.push_back({begin, [=](PhysicsServer& server, const Bodies& bodies) {
                                     server.attach(bodies[kTissue], {.ball = Ball{at, radius}, .to = bodies[body]});
                                 }});
    }

    /// The tissue is changed by a command.
    void change()
    {
        ++report_.changes;
        const SoftMaterial& before = std::get<SoftBodyDef>(scene_.bodies[kTissue]).material;
        const auto* fem = std::get_if<FemMaterial>(&before);
        const double time = now();
        wait(10);
        if (!fem) {
            ShellMaterial material = randomShell(size_, random_);
            material.validStrain = scene_.validStrain;
            material.thickness = std::get<ShellMaterial>(before).thickness; // the mass stays
            scene_.events.push_back(
                {time,
                 [=](PhysicsServer& server, const Bodies& bodies) { server.setMaterial(bodies[kTissue], material); },
                 true});
        } else if (!fem->fibres.empty() && random_.chance(0.5)) {
            const double stress = fem->youngModulus * random_.uniform(0.0, 1.0);
            scene_.events.push_back({time, [=](PhysicsServer& server, const Bodies& bodies) {
                                         server.setFibreStress(bodies[kTissue], 0, stress);
                                     }});
        } else if (random_.chance(0.5)) {
            const TissueRegion burn{.where = Ball{middle_ + 0.5 * size_ * random_.direction(), 0.4 * size_},
                                    .youngModulus = fem->youngModulus * random_.logarithmic(0.3, 10.0),
                                    .restScale = random_.uniform(0.7, 1.1)};
            scene_.events.push_back(
                {time, [=](PhysicsServer& server, const Bodies& bodies) { server.setTissue(bodies[kTissue], burn); },
                 true});
        } else {
            FemMaterial material = *fem; // another law
            const auto laws = static_cast<int>(std::variant_size_v<ElasticLaw>);
            material.law = randomLaw(static_cast<std::size_t>(random_.below(laws)), random_);
            scene_.events.push_back(
                {time,
                 [=](PhysicsServer& server, const Bodies& bodies) { server.setMaterial(bodies[kTissue], material); },
                 true});
        }
    }

    std::size_t kind_;
    FuzzRandom& random_;
    LawFuzzKind& counts_;
    LawFuzzReport& report_;
    LawScene scene_;
    double size_ = 0.0, friction_ = 0.0, top_ = 0.0;
    Vec3 middle_, extent_; ///< [m] the first body's
    int steps_ = 0;        ///< [-] before what is added next
};

} // namespace

std::string nameOfLawKind(std::size_t kind)
{
    if (kind + 1 == kLawKinds) return "shell";
    FuzzRandom random(1);
    return std::string(nameOf(randomLaw(kind, random)));
}

LawScene lawScene(std::size_t kind, FuzzRandom& random, LawFuzzKind& counts, LawFuzzReport& report)
{
    return LawSceneMaker(kind, random, counts, report).make();
}

} // namespace filasofia::testing
