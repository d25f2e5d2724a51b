#include "apps/laparoscopy/box.h"

#include <filasofia/core/random.h>

#include <numbers>

using namespace filasofia;

namespace laparoscopy {
namespace {

enum Group { OnBoard, OnPegs, OnTable, OnRings, LeftTool, RightTool };
constexpr double kPegRadius = 1.3_mm, kHole = 5.5_mm, kWall = 3.3_mm;
constexpr Vec3 kBoard = {150_mm, 8_mm, 106_mm};

/// A ring, as high as kRingHeight, with `around` points on each of its outlines and edges taken off by `bevel`.
std::shared_ptr<const TriangleMesh> ringMesh(int around, double bevel)
{
    const double half = 0.5 * kRingHeight, in = kHole, out = kHole + kWall;
    std::vector<Vec3> wall = {{out, -half, 0}, {out, half, 0}, {in, half, 0}, {in, -half, 0}};
    if (bevel > 0.0)
        wall = {{out, -half + bevel, 0}, {out, half - bevel, 0}, {out - bevel, half, 0}, {in + bevel, half, 0},
                {in, half - bevel, 0},   {in, -half + bevel, 0}, {in + bevel, -half, 0}, {out - bevel, -half, 0}};
    return shapes::revolved(wall, around);
}

/// The pegs in the board's coordinates; they begin inside it.
std::shared_ptr<const TriangleMesh> pegMesh(int sides)
{
    TriangleMesh mesh;
    const auto peg = shapes::cylinder(kPegRadius, kPegHeight + 4_mm, sides);
    for (int i = 0; i < 2 * kPegs; ++i) {
        const int first = static_cast<int>(mesh.vertices.size());
        const Vec3 at =
            pegAt(i < kPegs ? LeftSide : RightSide, i % kPegs) + Vec3{0, 0.5 * (kBoard.y + kPegHeight) - 2_mm, 0};
        for (const Vec3& vertex : peg->vertices) mesh.vertices.push_back(vertex + at);
        for (const auto& [a, b, c] : peg->triangles) mesh.triangles.push_back({first + a, first + b, first + c});
    }
    return std::make_shared<const TriangleMesh>(mesh);
}

} // namespace

TissueMaterial plain(Color color, double wetness)
{
    return {.baseColor = color,
            .subsurfaceColor = color,
            .vesselColor = color,
            .roughness = 0.5,
            .wetness = wetness,
            .thickness = 0.0,
            .mottling = 0.0,
            .vessels = 0.0,
            .bump = 0.02};
}

Vec3 pegAt(Side side, int peg)
{
    const double x = peg < 3 ? 50_mm : 23_mm;
    return {side == LeftSide ? -x : x, 0, (peg % 3 - 1) * 28_mm};
}

PegBox addBox(Simulation& sim, int rings, std::uint64_t seed)
{
    const auto slab = shapes::box(kBoard);
    PegBox box;
    // The board lies on foam: a tool that presses on it is held up, and a hand feels it.
    RigidBodyDef board{.name = "board", .elements = {{{0, -0.5 * kBoard.y, 0}, {}}}, .mesh = slab, .dynamic = true};
    board.mass = TotalMass{0.4};
    board.gravity = false;
    board.linearDamping = board.angularDamping = 20.0;
    board.friction = 0.5;
    board.attachments = {{.stiffness = 2e4}};
    board.collision = {{.primitives = {.points = false, .lines = false}, .proximity = 0.5_mm, .group = OnBoard},
                       {.primitives = {.points = false, .lines = false}, .proximity = 0.5_mm, .group = LeftTool},
                       {.primitives = {.points = false, .lines = false}, .proximity = 0.5_mm, .group = RightTool},
                       {.mesh = pegMesh(2), .proximity = 0.5_mm, .group = OnPegs}};
    box.board = sim.add(board);
    sim.show(box.board, {.material = plain({0.62, 0.60, 0.53}, 0.0)});
    sim.show(box.board, {.surface = pegMesh(6), .material = MetalMaterial{.roughness = 0.35}});

    RigidBodyDef table{.name = "table", .elements = {{{0, -kBoard.y - 5_mm, 0}, {}}}};
    table.mesh = shapes::box({600_mm, 10_mm, 500_mm});
    table.collision = {{.primitives = {.points = false, .lines = false}, .group = OnTable}};
    sim.show(sim.add(table), {.material = plain({0.05, 0.16, 0.20}, 0.0)});

    Random random(seed);
    const auto look = ringMesh(64, 0.9_mm), solid = ringMesh(16, 0.0), feet = ringMesh(8, 0.0);
    const std::array<Color, 3> colors = {{{0.75, 0.30, 0.06}, {0.08, 0.35, 0.55}, {0.60, 0.55, 0.10}}};
    for (int i = 0; i < rings; ++i) {
        const Vec3 shift = {random.between(-2.5_mm, 2.5_mm), 0.5 * kRingHeight + 0.2_mm,
                            random.between(-2.5_mm, 2.5_mm)};
        RigidBodyDef ring{.name = text("ring ", i + 1),
                          .elements = {{pegAt(LeftSide, i) + shift, {}}},
                          .mesh = solid,
                          .dynamic = true,
                          .mass = Density{1100.0},
                          .linearDamping = 2.0,
                          .angularDamping = 10.0};
        ring.friction = 0.6;
        // Few points bear it on the board.
        const physics::Primitives points{.lines = false, .triangles = false};
        ring.collision = {{.mesh = feet, .primitives = points, .proximity = 0.5_mm, .group = OnBoard},
                          {.mesh = feet, .primitives = points, .proximity = 0.5_mm, .group = OnTable},
                          {.proximity = 0.5_mm, .group = OnPegs},
                          {.proximity = 0.5_mm, .group = OnRings},
                          {.proximity = 0.5_mm, .group = LeftTool},
                          {.proximity = 0.5_mm, .group = RightTool}};
        box.rings.push_back(sim.add(ring));
        sim.show(box.rings.back(), {.surface = look, .material = plain(colors[static_cast<std::size_t>(i) % 3], 0.3)});
    }
    return box;
}

LaparoscopicInstrumentDef instrumentOf(Side side, const Training& training)
{
    const double sign = side == LeftSide ? -1.0 : 1.0;
    const Vec3 port = {sign * 85_mm, 120_mm, 140_mm}, work = {sign * 20_mm, 20_mm, 0};
    LaparoscopicInstrumentDef def{.name = side == LeftSide ? "left grasper" : "right grasper"};
    def.tool.groups = {side == LeftSide ? LeftTool : RightTool};
    def.tool.gripStiffness = 1000.0;
    def.tool.closingTorque = 60e-3;
    def.tool.proximity = 0.5_mm;
    def.tool.opening = 0.4;
    def.tool.shaftMaterial = plain({0.025, 0.026, 0.028}, 0.3);
    def.trocar = {
        .fulcrum = port, .axis = work - port, .mostTilt = 0.9, .leastInsertion = 30_mm, .mostInsertion = 260_mm};
    def.hand = {.length = 0.40, .strength = 10.0, .haptic = training.devices > (side == RightSide ? 0 : 1)};
    def.start = {.insertion = length(work - port) - 45_mm};
    return def;
}

TrocarHandsDef handsOf(Simulation& sim, const LaparoscopicInstrument& left, const LaparoscopicInstrument& right)
{
    TrocarHandsDef def;
    if (right.handle()) def.rightDevice = sim.add(HapticInterfaceDef{.name = "right hand", .body = right.handle()});
    if (left.handle()) def.leftDevice = sim.add(HapticInterfaceDef{.name = "left hand", .body = left.handle()});
    return def;
}

void useOwnJaws(LaparoscopicInstrumentDef& def)
{
    const LaparoscopicInstrumentDef own;
    def.tool.groups = own.tool.groups;
    def.tool.gripStiffness = own.tool.gripStiffness;
    def.tool.closingTorque = own.tool.closingTorque;
    def.tool.proximity = own.tool.proximity;
}

LaparoscopeDef scopeOf()
{
    const Vec3 middle = {0, 4_mm, 2_mm}, view = normalized(Vec3{0, -0.80, -0.60});
    LaparoscopeDef def{.intensity = 60.0};
    const Vec3 shaft = rotate(axisAngle({1, 0, 0}, def.inclination), view); // the view is so far below it
    const double inside = 50_mm, distance = 138_mm;
    def.trocar = {.fulcrum = middle - distance * view - inside * shaft, .axis = shaft};
    def.start = {.insertion = inside};
    def.surroundings = {.intensity = 1500.0,
                        .above = {0.95, 0.97, 1.0},
                        .below = {0.35, 0.36, 0.38},
                        .lampStrength = 1.0,
                        .background = {0.02, 0.02, 0.025}};
    return def;
}

std::vector<TrackedBody> observedIn(const LaparoscopicInstrument& first, const LaparoscopicInstrument& second,
                                    const Laparoscope& scope)
{
    return {{.body = first.body(), .tip = {0, 0, -18_mm}},
            {.body = second.body(), .tip = {0, 0, -18_mm}},
            {.body = scope.body(), .role = Role::Scope, .element = Endoscope::kCamera}};
}

TaskStep step(const char* name, const char* instruction, std::function<bool()> done)
{
    return {.name = name, .instruction = instruction, .done = [done = std::move(done)](const auto&) { return done(); }};
}

int play(const Training& training, TrocarHands& hands, const std::function<TrocarPlan()>& expert,
         const std::function<TrocarPlan()>& clumsy)
{
    if (training.motion != "expert" && training.motion != "clumsy") return 0;
    const TrocarPlan plan = training.motion == "expert" ? expert() : clumsy();
    hands.play(plan.moves());
    return stepsIn(plan.seconds() + 0.2);
}

std::optional<int> pegOf(const Pose& ring, Side side)
{
    for (int peg = 0; peg < kPegs; ++peg) {
        const Vec3 from = transform(inverse(ring), pegAt(side, peg) + Vec3{0, ring.position.y, 0});
        if (std::hypot(from.x, from.z) < kHole && ring.position.y < kPegHeight) return peg;
    }
    return {};
}

} // namespace laparoscopy
