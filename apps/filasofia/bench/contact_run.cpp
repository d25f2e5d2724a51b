#include "apps/filasofia/bench/contact_run.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/engines.h"

#include <algorithm>
#include <cmath>

namespace filasofia::app {
namespace {

namespace shapes = geometry::shapes;

constexpr Vec3 kGravity{0.0, -9.81, 0.0};
constexpr double kFriction = 0.5;

/// A motion that presses a tool down and then scrapes it along x.
struct Scrape {
    Pose touching;                           ///< pose of first touch
    double depth, speed, reach;              ///< [m], [m/s] peak speed, [m]
    double above = 0.03, stand = 0.7;        ///< [m], [s] height at which it waits, and how long
    static constexpr double kApproach = 0.1; ///< [m/s]

    [[nodiscard]] double begins() const { return stand + (above + depth) / kApproach; } ///< [s] start of the scraping
    [[nodiscard]] Pose at(double time) const
    {
        Pose pose = touching;
        pose.position.y += std::max(-depth, above - kApproach * std::max(0.0, time - stand));
        pose.position.x += reach * std::sin(speed / reach * std::max(0.0, time - begins()));
        return pose;
    }
};

ToolPath pathOf(BodyId tool, const Scrape& scrape)
{
    return [tool, scrape](double time) { return std::vector{std::pair{tool, scrape.at(time)}}; };
}

/// A cube with `cells` cells along each edge, deformed into a ball shell by shell.
std::shared_ptr<const geometry::TetMesh> softBall(int cells, double radius)
{
    // [-] Below 1, because in an exact sphere the cube's edges would be flat, and so would the tetrahedra there.
    constexpr double kRound = 0.9;
    geometry::TetMesh mesh = *shapes::block({2, 2, 2}, {cells, cells, cells});
    for (Vec3& p : mesh.nodes) {
        const double shell = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), from = length(p);
        if (from > 0.0) p = radius * ((1.0 - kRound) + kRound * shell / from) * p;
    }
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

physics::SoftBodyDef soft(const std::string& name, std::shared_ptr<const geometry::TetMesh> mesh, Vec3 at)
{
    physics::SoftBodyDef def{.name = name, .mesh = std::move(mesh)};
    def.pose.position = at;
    def.collision = {{}};
    def.friction = kFriction;
    return def;
}

/// A plate curved about an axis along x, with the middle of its lower side at the origin: it lies on a back like a
/// hand.
struct BentPlate {
    /// [m] radius, thickness and lengths of its lower side
    double radius = 0.09, thick = 0.006, along = 0.07, around = 0.1;

    [[nodiscard]] std::shared_ptr<const geometry::TriangleMesh> surface() const
    {
        geometry::TriangleMesh mesh = *shapes::box({along, thick, around}, {16, 1, 22});
        for (Vec3& p : mesh.vertices) {
            const double out = radius + 0.5 * thick + p.y, angle = p.z / radius;
            p = {p.x, out * std::cos(angle) - radius, out * std::sin(angle)};
        }
        return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
    }
    /// [m] The height at which the plate, placed at (x, z) = (at.x, 0), touches those points from above. Points up to
    /// `reach` beside it along x count too.
    [[nodiscard]] double touch(const std::vector<Vec3>& points, Vec3 at, double reach) const
    {
        double height = -1.0;
        for (Vec3 p : points)
            if (std::abs(p.x - at.x) < 0.5 * along + reach && std::abs(p.z) < radius * std::sin(0.5 * around / radius))
                height = std::max(height, p.y + radius - std::sqrt(radius * radius - p.z * p.z));
        return height;
    }
};

/// The positions of a body's nodes after it has come to rest.
std::vector<Vec3> standing(const physics::SoftBodyDef& def)
{
    constexpr int kSteps = 1000;
    ContactScene alone;
    alone.bodies = {def};
    ContactRun run(alone, 1);
    for (int i = 0; i < kSteps; ++i) run.step();
    return run.capture().softBodies.front().positions;
}

} // namespace

int ContactScene::elements() const
{
    std::size_t count = 0;
    for (const physics::BodyDef& def : bodies)
        if (const auto* softBody = std::get_if<physics::SoftBodyDef>(&def))
            count += physics::loadMesh(*softBody)->tetrahedra.size();
    return static_cast<int>(count);
}

ContactRun::ContactRun(const ContactScene& scene, int threads, bool contacts, const std::string& engine)
    : engine_(runtime::makeEngine(engine.empty() ? runtime::engineNames().front() : engine,
                                  {.period = scene.step, .threads = threads})),
      dt_(scene.step), path_(scene.path), gravity_(scene.gravity)
{
    commands_.emplace_back(physics::SetGravity{kGravity});
    std::uint32_t id = 0, attachments = 0;
    for (physics::BodyDef def : contacts || scene.compared.empty() ? scene.bodies : scene.compared) {
        const AttachmentId first{attachments + 1};
        std::visit(
            [&](auto& d) {
                if (!contacts) d.collision = {};
                attachments += static_cast<std::uint32_t>(d.attachments.size());
            },
            def);
        const auto shared = std::make_shared<const physics::BodyDef>(std::move(def));
        commands_.emplace_back(physics::AddBody{BodyId{++id}, shared, engine_->build(*shared), first});
    }
    engine_->step({.dt = 0.0, .commands = commands_});
}

physics::StepReport ContactRun::step(const physics::StepBudget* budget)
{
    commands_.clear();
    time_ += dt_;
    if (gravity_) commands_.emplace_back(physics::SetGravity{gravity_(time_)});
    if (path_)
        for (const auto& [body, pose] : path_(time_)) commands_.emplace_back(physics::SetPose{body, 0, pose});
    return engine_->step({.dt = dt_, .commands = commands_, .budget = budget});
}

const frame::Frame& ContactRun::capture()
{
    engine_->capture(frame_);
    return frame_;
}

double pressedBy(const frame::Frame& frame)
{
    double force = 0.0;
    for (const frame::Contact& contact : frame.contacts) force += contact.normalForce;
    return force;
}

int iterationsOf(const physics::StepReport& report)
{
    int highest = 0;
    for (const physics::BodySolve& solve : report.solves) highest = std::max(highest, solve.iterations);
    return highest;
}

physics::SoftBodyDef contactBunny(int tets, bool pinned)
{
    auto mesh = std::make_shared<const geometry::TetMesh>(
        geometry::loadTetMesh(runtime::asset(text("meshes/bunny_", tets, ".msh"))));
    physics::SoftBodyDef def = soft("bunny", std::move(mesh), {0, pinned ? 0.0 : 5e-4, 0});
    if (pinned) def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.02, 1}}}};
    return def;
}

physics::RigidBodyDef contactTool(const std::string& name, std::shared_ptr<const geometry::TriangleMesh> mesh, Pose at)
{
    physics::RigidBodyDef def{.name = name, .elements = {at}, .mesh = std::move(mesh)};
    def.collision = {{}};
    def.friction = kFriction;
    return def;
}

physics::RigidBodyDef contactFloor() { return contactTool("floor", shapes::box({1.0, 0.1, 1.0}), {{0, -0.05, 0}, {}}); }

ContactScene bunnyOnFloor(int tets)
{
    return {.name = "at rest on a floor",
            .body = text("bunny ", tets),
            .bodies = {contactFloor(), contactBunny(tets, false)},
            .settle = 1.0};
}

ContactScene bunnyScraped(int tets, double speed)
{
    constexpr Vec3 back{0.052, 0.0, 0.0}; // behind the ears
    constexpr double kReach = 0.01;       // [m] to either side
    const BentPlate plate;
    ContactScene scene{.name = text("scraped at ", speed, " m/s"), .body = text("bunny ", tets)};
    const physics::SoftBodyDef bunny = contactBunny(tets, true);
    const double top = plate.touch(standing(bunny), back, kReach);
    const Scrape scrape{.touching = {back + Vec3{0.0, top, 0.0}, {}}, .depth = 0.02, .speed = speed, .reach = kReach};
    scene.bodies = {bunny, contactTool("tool", plate.surface(), scrape.at(0.0))};
    scene.path = pathOf(BodyId{2}, scrape);
    scene.settle = scrape.begins() + 0.1;
    scene.asked = 60;
    return scene;
}

ContactScene plateOnSlab(int contacts)
{
    constexpr std::array<int, 3> cells{36, 4, 35};
    constexpr double cell = 5e-3, thick = cells[1] * cell;
    ContactScene scene{.name = text("plate, ", contacts, " contacts"), .body = "slab 30240", .asked = contacts};
    physics::SoftBodyDef slab =
        soft("slab", shapes::block({cells[0] * cell, thick, cells[2] * cell}, cells), {0.0, 0.5 * thick, 0.0});
    slab.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
    const double edge = cell * std::sqrt(1.05 * contacts); // one node of the slab per cell; not all of them push
    const Scrape scrape{.touching = {{0.0011, thick + 5e-3, 0.0013}, {}},
                        .depth = 2e-3,
                        .speed = 0.1,
                        .reach = 2e-3,
                        .above = 2e-3,
                        .stand = 0.1};
    scene.bodies = {slab, contactTool("plate", shapes::box({edge, 0.01, edge}), scrape.at(0.0))};
    scene.path = pathOf(BodyId{2}, scrape);
    scene.settle = scrape.begins() + 0.1;
    return scene;
}

ContactScene blockOnBlock()
{
    physics::SoftBodyDef low = soft("low", shapes::block({0.06, 0.02, 0.06}, {12, 4, 12}), {0.0, 0.01, 0.0});
    low.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
    const physics::SoftBodyDef high =
        soft("high", shapes::block({0.04, 0.02, 0.04}, {8, 4, 8}), {-0.0013, 0.0305, 0.0009});
    return {.name = "soft on soft", .body = "blocks", .bodies = {low, high}, .settle = 1.0};
}

ContactScene ballOnFloor()
{
    return {.name = "dropped on a floor",
            .body = "soft ball",
            .bodies = {contactFloor(), soft("ball", softBall(8, 0.02), {0, 0.04, 0})},
            .settle = 1.0};
}

ContactScene towerOfFive()
{
    ContactScene scene{.name = "five boxes", .body = "tower", .bodies = {contactFloor()}, .settle = 1.0};
    for (int k = 0; k < 5; ++k) {
        physics::RigidBodyDef box =
            contactTool(text("box ", k), shapes::box({0.04, 0.04, 0.04}), {{0, 0.02001 + 0.04001 * k, 0}, {}});
        box.dynamic = true;
        scene.bodies.push_back(box);
    }
    return scene;
}

ContactScene tiedBlocks(double stiffness)
{
    using physics::AttachmentDef;
    struct Layer {
        double height; ///< [m]
        int cells;
        double young; ///< [Pa]
    };
    constexpr Layer liver{0.02, 4, 8e3}, layer{0.0025, 1, 4e3}, organ{0.01, 3, 25e3};
    const auto block = [](const char* name, double bottom, const Layer& of, std::vector<AttachmentDef> attachments) {
        return physics::SoftBodyDef{.name = name,
                                    .mesh = shapes::block({0.06, of.height, 0.04}, {15, of.cells, 10}),
                                    .pose = {{0, bottom + 0.5 * of.height, 0}, {}},
                                    .material = physics::FemMaterial{.youngModulus = of.young, .poissonRatio = 0.45},
                                    .attachments = std::move(attachments)};
    };
    constexpr double kUp = 0.03, kBottom = -0.02; // [m] where the hand is, and what lies on the ground
    const physics::RigidBodyDef hand{.name = "hand", .elements = {{{0, kUp, 0}, {}}}};
    const AttachmentDef ground{.box = geometry::Box{{-1, -1, -1}, {1, -0.0199, 1}}};
    const AttachmentDef pulled{.box = geometry::Box{{-1, 0.0124, -1}, {-0.02, 1, 1}}, .to = BodyId{1}};
    const auto tiedTo = [&](std::uint32_t body) {
        return AttachmentDef{.within = 3e-4, .stiffness = stiffness, .to = BodyId{body}};
    };
    const auto drawn = [=](double time) {
        return std::vector{std::pair{BodyId{1}, Pose{{0, kUp + 0.01 * std::sin(2.0 * time), 0}, {}}}};
    };
    // The same layers in one mesh: those of a block of eight equal ones are moved.
    const double whole = liver.height + layer.height + organ.height;
    const int cells = liver.cells + layer.cells + organ.cells;
    physics::SoftBodyDef one = block("one", kBottom, {whole, cells, liver.young}, {ground, pulled});
    auto mesh = std::make_shared<geometry::TetMesh>(*std::get<1>(one.mesh));
    for (Vec3& node : mesh->nodes) {
        double level = std::round((node.y / whole + 0.5) * cells);
        node.y = -0.5 * whole;
        for (const Layer& each : {liver, layer, organ}) {
            node.y += each.height / each.cells * std::clamp(level, 0.0, static_cast<double>(each.cells));
            level -= each.cells;
        }
    }
    one.mesh = std::shared_ptr<const geometry::TetMesh>(std::move(mesh));
    const double upper = kBottom + liver.height + layer.height;
    std::get<physics::FemMaterial>(one.material).regions = {
        {.where = geometry::Box{{-1, kBottom + liver.height, -1}, {1, upper, 1}}, .youngModulus = layer.young},
        {.where = geometry::Box{{-1, upper, -1}, {1, 1, 1}}, .youngModulus = organ.young}};
    return {.name = stiffness == physics::kHard ? std::string("tied hard") : text("tied by ", stiffness, " N/m"),
            .body = "three blocks",
            .bodies = {hand, block("liver", kBottom, liver, {ground}), block("organ", upper, organ, {pulled}),
                       block("layer", kBottom + liver.height, layer, {tiedTo(2), tiedTo(3)})},
            .compared = {hand, one},
            .path = drawn};
}

ContactScene gripAtRest(double stiffness)
{
    constexpr Vec3 organ{0.04, 0.02, 0.03}, jaw{0.012, 0.004, 0.012};
    constexpr double kPressed = 1e-3; // [m] by each jaw
    const double away = 0.5 * (organ.y + jaw.y) - kPressed;
    physics::SoftBodyDef held = soft("organ", shapes::block(organ, {12, 6, 9}), {});
    held.material = physics::FemMaterial{.youngModulus = 25e3, .poissonRatio = 0.45};
    held.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-0.5 * organ.x + 1e-6, 1, 1}}}};
    ContactScene scene{.name = text("held by ", stiffness, " N/m"), .body = "grip", .compared = {held}, .settle = 2.0};
    for (int side : {-1, 1})
        scene.bodies.push_back(contactTool(side < 0 ? "lower jaw" : "upper jaw", shapes::box(jaw),
                                           {{0.5 * (organ.x - jaw.x), side * away, 0.0}, {}}));
    for (std::uint32_t each : {1u, 2u})
        held.attachments.push_back({.within = 2e-3, .stiffness = stiffness, .to = BodyId{each}});
    scene.bodies.push_back(held);
    return scene;
}

ContactScene boxesAtRest()
{
    constexpr double kEdge = 0.04, kGap = 5e-4;
    ContactScene scene{.name = "four layers", .body = "64 boxes", .bodies = {contactFloor()}, .settle = 2.0};
    for (int k = 0; k < 64; ++k) {
        const int layer = k / 16;
        const double shift = layer % 2 == 0 ? 0.0 : 0.25 * kEdge, pitch = kEdge + kGap;
        physics::RigidBodyDef box =
            contactTool(text("box ", k), shapes::box({kEdge, kEdge, kEdge}),
                        {{pitch * (k % 4) + shift, (0.5 + layer) * (kEdge + 1e-5), pitch * (k / 4 % 4) + shift}, {}});
        box.dynamic = true;
        scene.bodies.push_back(box);
    }
    return scene;
}

ContactScene softHeap()
{
    constexpr double kWide = 0.12, kHigh = 0.2, kThick = 0.02;
    constexpr Vec3 block{0.02, 0.02, 0.025};
    ContactScene scene{
        .name = "50 soft blocks", .body = "heap", .bodies = {contactFloor()}, .settle = 3.0, .step = 5e-3};
    for (int side : {-1, 1}) {
        const double away = side * 0.5 * (kWide + kThick);
        scene.bodies.push_back(
            contactTool("wall", shapes::box({kThick, kHigh, kWide + 2 * kThick}), {{away, 0.5 * kHigh, 0}, {}}));
        scene.bodies.push_back(contactTool("wall", shapes::box({kWide, kHigh, kThick}), {{0, 0.5 * kHigh, away}, {}}));
    }
    for (int k = 0; k < 50; ++k) { // layers of nine, each turned a little against the last
        const int layer = k / 9, x = k % 3 - 1, z = k / 3 % 3 - 1;
        physics::SoftBodyDef each = soft(text("block ", k), shapes::block(block, {4, 4, 5}), {});
        each.pose = {{0.034 * x, 0.02 + 0.032 * layer, 0.034 * z}, axisAngle({0, 1, 0}, 0.3 * layer + 0.1 * x)};
        scene.bodies.push_back(each);
    }
    return scene;
}

} // namespace filasofia::app
