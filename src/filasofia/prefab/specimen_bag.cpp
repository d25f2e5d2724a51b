#include "filasofia/prefab/specimen_bag.h"

#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/solid_angle.h"

#include <algorithm>
#include <numbers>

namespace filasofia::prefab {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStraight = 0.6; ///< [-], part of the depth down to which the walls are upright
constexpr int kRound = 3;         ///< rings of the rounded bottom

/// The mouth at the start, in the world.
struct Mouth {
    std::array<Vec3, 3> corners = {}; ///< [m], the pivot, and the tips of the arms
    Vec3 down = {};                   ///< [-], a unit vector, to where the bag hangs
};

/// The nodes of the mouth: from the pivot along the first arm, along the free edge and back along the second arm.
std::vector<Vec3> rimOf(const Mouth& mouth, int cells)
{
    std::vector<Vec3> rim;
    for (std::size_t side = 0; side < 3; ++side)
        for (int i = 0; i < cells; ++i) {
            const Vec3 a = mouth.corners[side], b = mouth.corners[(side + 1) % 3];
            rim.push_back(a + static_cast<double>(i) / cells * (b - a));
        }
    return rim;
}

/// The round cross-section of the bag, as long around as its mouth. Walls that hang down from three straight sides are
/// as wide there as at the mouth.
struct Circle {
    Vec3 middle = {};                ///< [m], where the mouth has it
    double edge = 0.0, radius = 0.0; ///< [m], around it
    Vec3 first = {}, second = {};    ///< [-], unit vectors: to the pivot, and across, towards the tip of the first arm

    Circle(const Mouth& mouth, const std::vector<Vec3>& rim)
    {
        for (std::size_t i = 0; i < rim.size(); ++i) {
            middle += 1.0 / static_cast<double>(rim.size()) * rim[i];
            edge += distance(rim[i], rim[(i + 1) % rim.size()]);
        }
        radius = edge / (2.0 * kPi);
        first = normalized(rim.front() - middle);
        second = normalized((mouth.corners[1] - middle) - dot(mouth.corners[1] - middle, first) * first);
    }
    [[nodiscard]] Vec3 at(double angle) const
    {
        return middle + radius * (std::cos(angle) * first + std::sin(angle) * second);
    }
};

/// The triangles between rings of as many nodes, one below the other, and from the last ring to the node after it.
std::vector<geometry::Triangle> trianglesOf(int rings, int around)
{
    std::vector<geometry::Triangle> triangles;
    const int last = rings * around;
    for (int ring = 0; ring < rings; ++ring)
        for (int i = 0; i < around; ++i) {
            const int a = ring * around + i, b = ring * around + (i + 1) % around;
            if (ring + 1 == rings) {
                triangles.push_back({a, b, last});
                continue;
            }
            triangles.push_back({a, b, b + around});
            triangles.push_back({a, b + around, a + around});
        }
    return triangles;
}

/// The mesh of the film: rings of nodes, one below the other, and a node at the bottom. The first ring is the mouth.
geometry::TriangleMesh pouch(const Mouth& mouth, double depth, int cells)
{
    const std::vector<Vec3> rim = rimOf(mouth, cells);
    const Circle circle(mouth, rim);
    const int around = 3 * cells;
    const int straight = std::max(2, static_cast<int>(std::lround(kStraight * depth * around / circle.edge)));

    // The walls hang down, and turn from the triangle of the mouth into the circle; below, the bottom closes it.
    geometry::TriangleMesh mesh;
    for (int ring = 0; ring < straight + kRound; ++ring) {
        const double upright = std::min(1.0, static_cast<double>(ring) / straight);
        const double turn = 0.5 * kPi * std::max(0, ring - straight) / kRound;
        const double low = kStraight * upright + (1.0 - kStraight) * std::sin(turn);
        for (int i = 0; i < around; ++i) {
            const Vec3 above = rim[static_cast<std::size_t>(i)];
            const Vec3 flat = above + upright * (circle.at(2.0 * kPi * i / around) - above);
            mesh.vertices.push_back(circle.middle + std::cos(turn) * (flat - circle.middle) + low * depth * mouth.down);
        }
    }
    mesh.vertices.push_back(circle.middle + depth * mouth.down);
    mesh.triangles = trianglesOf(straight + kRound, around);
    // Whether it faces outwards depends on which arm is the first.
    if (dot(cross(circle.first, circle.second), mouth.down) < 0.0)
        for (auto& each : mesh.triangles) std::swap(each[1], each[2]);
    return mesh;
}

} // namespace

struct SpecimenBag::Impl {
    Impl(runtime::Simulation& sim, BodyId instrument, const SpecimenBagDef& given)
        : simulation(sim), tool(instrument), def(given)
    {
        const auto held = sim.physics().def(tool);
        const std::string object = text("specimen bag '", def.name, "'");
        const auto* rigid = std::get_if<physics::RigidBodyDef>(held.get());
        if (rigid == nullptr || rigid->articulation.joints.size() != 2)
            fail(object, ": the tool must be a rigid body with two joints, got ", physics::describeBody(*held));
        validate(def, object);
        const std::vector<Pose> poses = physics::elementPoses(*rigid);
        const auto tip = [&](std::size_t element) { return transform(poses[element], {0.0, 0.0, -def.arms}); };
        const Mouth open{{poses[0].position, tip(1), tip(2)}, rotate(poses[0].orientation, {-1.0, 0.0, 0.0})};
        if (distance(open.corners[1], open.corners[2]) < 0.1 * def.arms)
            fail(object, ": the tool must be open at the start: the tips of its arms are ",
                 distance(open.corners[1], open.corners[2]), " m from each other");
        mesh = std::make_shared<const geometry::TriangleMesh>(pouch(open, def.depth, def.cells));
        film = sim.add(bodyOf());
        sim.show(film, {.subdivision = 1, .material = def.material});
    }

    [[nodiscard]] int rim() const { return 3 * def.cells; }
    [[nodiscard]] physics::SoftBodyDef bodyOf() const
    {
        physics::SoftBodyDef body{
            .name = def.name, .mesh = mesh, .material = def.film, .mass = physics::Density{def.density}};
        body.rayleigh = def.rayleigh;
        body.friction = def.friction;
        for (const int group : def.groups)
            body.collision.push_back({.proximity = def.proximity, .group = group, .self = def.self});
        std::array<physics::AttachmentDef, 2> arms;
        for (int i = 0; i <= def.cells; ++i) arms[0].nodes.push_back(i);
        for (int i = 2 * def.cells; i < 3 * def.cells; ++i) arms[1].nodes.push_back(i);
        for (int i = 0; i < 2; ++i) {
            auto& arm = arms[static_cast<std::size_t>(i)];
            arm.to = tool;
            arm.element = i + 1;
            arm.stiffness = def.rimStiffness;
            body.attachments.push_back(arm);
        }
        return body;
    }

    [[nodiscard]] static Vec3 middleOf(const std::vector<Vec3>& nodes, int rim)
    {
        Vec3 middle;
        for (int i = 0; i < rim; ++i) middle += 1.0 / rim * nodes[static_cast<std::size_t>(i)];
        return middle;
    }

    /// The film and a lid over its mouth are closed: a point is inside if they go around it.
    [[nodiscard]] bool isIn(Vec3 point, const std::vector<Vec3>& nodes, Vec3 middle) const
    {
        const auto node = [&](int i) { return nodes[static_cast<std::size_t>(i)]; };
        double angle = 0.0; // 4 pi inside
        for (const auto& [a, b, c] : mesh->triangles) angle += geometry::solidAngle(point, node(a), node(b), node(c));
        // The lid has the edges of the mouth in the other direction.
        const auto& [a, b, c] = mesh->triangles.front();
        const bool same = (a == 0 && b == 1) || (b == 0 && c == 1) || (c == 0 && a == 1);
        for (int i = 0; i < rim(); ++i) {
            const int next = (i + 1) % rim();
            angle += geometry::solidAngle(point, node(same ? next : i), node(same ? i : next), middle);
        }
        return std::abs(angle) > 2.0 * kPi;
    }

    runtime::Simulation& simulation;
    const BodyId tool;
    const SpecimenBagDef def;
    std::shared_ptr<const geometry::TriangleMesh> mesh;
    BodyId film = {};
};

SpecimenBag::SpecimenBag(runtime::Simulation& simulation, ArticulatedInstrument& tool, const SpecimenBagDef& def)
    : SpecimenBag(simulation, tool.body(), def)
{
    tool.carries(transform(inverse(tool.pose()), mouth()));
}
SpecimenBag::SpecimenBag(runtime::Simulation& simulation, BodyId tool, const SpecimenBagDef& def)
    : impl_(std::make_unique<Impl>(simulation, tool, def))
{
}
SpecimenBag::~SpecimenBag() = default;

BodyId SpecimenBag::body() const { return impl_->film; }

double SpecimenBag::share(BodyId of) const
{
    const frame::FrameRef now = impl_->simulation.physics().latest();
    const frame::SoftBodyFrame* film = now ? now->softBody(impl_->film) : nullptr;
    if (film == nullptr) return 0.0;
    std::vector<Vec3> points;
    if (const auto* soft = now->softBody(of))
        points = soft->positions;
    else if (const auto* rigid = now->rigidBody(of))
        for (const Pose& each : rigid->poses) points.push_back(each.position);
    if (points.empty()) return 0.0;
    const Vec3 middle = Impl::middleOf(film->positions, impl_->rim());
    const auto in =
        std::ranges::count_if(points, [&](Vec3 each) { return impl_->isIn(each, film->positions, middle); });
    return static_cast<double>(in) / static_cast<double>(points.size());
}

Vec3 SpecimenBag::load() const
{
    const frame::FrameRef now = impl_->simulation.physics().latest();
    Vec3 sum;
    if (!now) return sum;
    for (const frame::Attachment& each : now->attachments)
        if (each.body == impl_->film && each.to == impl_->tool) sum -= each.force;
    return sum;
}

Vec3 SpecimenBag::mouth() const
{
    const frame::FrameRef now = impl_->simulation.physics().latest();
    const frame::SoftBodyFrame* film = now ? now->softBody(impl_->film) : nullptr;
    return Impl::middleOf(film ? film->positions : impl_->mesh->vertices, impl_->rim());
}

} // namespace filasofia::prefab
