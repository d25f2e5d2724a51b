#include "record/round_trip.h"

namespace recorded_bodies_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::record_test;

namespace {

using Surface = std::shared_ptr<const geometry::TriangleMesh>;

Surface corner()
{
    const geometry::TriangleMesh mesh{{kVec, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {{kThird, 0}, {1, 0}, {0, 1}}};
    return std::make_shared<const geometry::TriangleMesh>(mesh);
}

void checkSame(const TriangleMeshSource& a, const TriangleMeshSource& b)
{
    const geometry::TriangleMesh &one = *std::get<Surface>(a), &two = *std::get<Surface>(b);
    CHECK(one.triangles == two.triangles);
    CHECK(one.uv == two.uv);
    REQUIRE(one.vertices.size() == two.vertices.size());
    for (std::size_t i = 0; i < one.vertices.size(); ++i) CHECK(sameBits(one.vertices[i], two.vertices[i]));
}

const CollisionDef kCollision{.mesh = corner(),
                              .element = 1,
                              .primitives = {.points = false, .lines = true, .triangles = false},
                              .proximity = kThird,
                              .group = -3,
                              .self = true,
                              .cutting = true};

void checkSame(const CollisionDef& a, const CollisionDef& b)
{
    checkSame(a.mesh, b.mesh);
    CHECK((a.element == b.element && a.group == b.group && a.self == b.self && a.cutting == b.cutting));
    CHECK((a.primitives.points == b.primitives.points && a.primitives.lines == b.primitives.lines));
    CHECK(a.primitives.triangles == b.primitives.triangles);
    CHECK(sameBits(a.proximity, b.proximity));
}

const AttachmentDef kAttachment{.nodes = {2, 0},
                                .box = geometry::Box{kVec, {1, 2, 3}},
                                .ball = Ball{kVec, kThird},
                                .within = kTiny,
                                .stiffness = kThird,
                                .to = {7},
                                .element = 3,
                                .mode = AttachMode::Nearest,
                                .breakForce = kLarge,
                                .toNodes = {1, 5}};

void checkSame(const AttachmentDef& a, const AttachmentDef& b)
{
    CHECK((a.nodes == b.nodes && a.box == b.box && a.to == b.to && a.element == b.element && a.mode == b.mode));
    REQUIRE((a.ball && b.ball && a.within && b.within));
    CHECK((sameBits(a.ball->centre, b.ball->centre) && sameBits(a.ball->radius, b.ball->radius)));
    CHECK((sameBits(*a.within, *b.within) && sameBits(a.stiffness, b.stiffness)));
    CHECK(sameBits(a.breakForce, b.breakForce));
    CHECK(a.toNodes == b.toNodes);
}

const RigidAttachmentDef kRigidAttachment{
    .element = 2, .points = {kVec, {1, 2, 3}}, .stiffness = kThird, .to = {8}, .toElement = 4, .breakForce = kLarge};

void checkSame(const RigidAttachmentDef& a, const RigidAttachmentDef& b)
{
    CHECK((a.element == b.element && a.to == b.to && a.toElement == b.toElement));
    REQUIRE(a.points.size() == b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) CHECK(sameBits(a.points[i], b.points[i]));
    CHECK((sameBits(a.stiffness, b.stiffness) && sameBits(a.breakForce, b.breakForce)));
}

} // namespace

TEST_CASE("every field of a rigid body comes back bit for bit, its surfaces with it")
{
    const RigidBodyDef def{
        .name = "forceps",
        .elements = {kPose, Pose{}},
        .mesh = corner(),
        .dynamic = true,
        .mass = GivenInertia{.mass = kThird, .centre = kVec, .moments = {kThird, 1, kTiny}, .axes = kPose.orientation},
        .velocity = kVec,
        .angularVelocity = {kThird, -0.0, kLarge},
        .linearDamping = kThird,
        .angularDamping = kTiny,
        .gravity = false,
        .collision = {kCollision, {}},
        .friction = kThird,
        .attachments = {kRigidAttachment, {}}};
    const RigidBodyDef back = roundTrip(def);
    CHECK(back.name == "forceps");
    REQUIRE(back.elements.size() == 2);
    CHECK(sameBits(back.elements[0], kPose));
    checkSame(back.mesh, def.mesh);
    CHECK((back.dynamic && !back.gravity));
    const auto& mass = std::get<GivenInertia>(back.mass);
    CHECK((sameBits(mass.mass, kThird) && sameBits(mass.centre, kVec) && sameBits(mass.moments, {kThird, 1, kTiny})));
    CHECK(sameBits(mass.axes, kPose.orientation));
    CHECK((sameBits(back.velocity, kVec) && sameBits(back.angularVelocity, {kThird, -0.0, kLarge})));
    CHECK((sameBits(back.linearDamping, kThird) && sameBits(back.angularDamping, kTiny)));
    CHECK(sameBits(back.friction, kThird));
    REQUIRE(back.collision.size() == 2);
    checkSame(back.collision[0], kCollision);
    CHECK(std::get<std::string>(back.collision[1].mesh).empty());
    REQUIRE(back.attachments.size() == 2);
    checkSame(back.attachments[0], kRigidAttachment);
    CHECK((back.attachments[1].points.empty() && back.attachments[1].stiffness == kHard && !back.attachments[1].to));
    CHECK(back.attachments[1].breakForce == kNever);
}

TEST_CASE("a soft body's collision models and attachments come back bit for bit")
{
    const SoftBodyDef back = roundTrip(SoftBodyDef{
        .mesh = oneTetrahedron(), .attachments = {kAttachment, {}}, .collision = {kCollision, {}}, .friction = kThird});
    CHECK(sameBits(back.friction, kThird));
    REQUIRE(back.collision.size() == 2);
    checkSame(back.collision[0], kCollision);
    REQUIRE(back.attachments.size() == 2);
    checkSame(back.attachments[0], kAttachment);
    CHECK((!back.attachments[1].box && !back.attachments[1].ball && !back.attachments[1].within));
    CHECK((back.attachments[1].mode == AttachMode::Barycentric && back.attachments[1].breakForce == kNever));
}

TEST_CASE("commands that attach and release come back bit for bit")
{
    AddBody add = adding(4, SoftBodyDef{.mesh = oneTetrahedron(), .attachments = {kAttachment}});
    add.attachments = {17};
    CHECK(roundTrip(std::move(add)).attachments == AttachmentId{17});
    const Attach attach = roundTrip(Attach{{3}, {4}, kAttachment});
    CHECK((attach.id == AttachmentId{3} && attach.body == BodyId{4}));
    checkSame(attach.def, kAttachment);
    const AttachRigid rigid = roundTrip(AttachRigid{{4294967295u}, {4}, kRigidAttachment});
    CHECK((rigid.id == AttachmentId{4294967295u} && rigid.body == BodyId{4}));
    checkSame(rigid.def, kRigidAttachment);
    CHECK(roundTrip(Release{{5}}).id == AttachmentId{5});
    const Grasp grasp = roundTrip(Grasp{{6}, {7}, {8}, {.stiffness = kThird, .breakForce = kLarge}});
    CHECK((grasp.id == AttachmentId{6} && grasp.rigid == BodyId{7} && grasp.target == BodyId{8}));
    CHECK((sameBits(grasp.def.stiffness, kThird) && sameBits(grasp.def.breakForce, kLarge) && !grasp.def.mouth));
    const Mouth mouth{2, {kThird, 0, 1}, {0, 1, 0}, kThird, {kLarge, 0, 0}};
    const Grasp jaws = roundTrip(Grasp{{6}, {7}, {8}, {.mouth = mouth}});
    REQUIRE(jaws.def.mouth);
    CHECK((jaws.def.mouth->element == 2 && jaws.def.mouth->length == kThird && jaws.def.mouth->pivot == mouth.pivot));
    CHECK((jaws.def.mouth->forward == mouth.forward && jaws.def.mouth->opens == mouth.opens));
}

} // namespace recorded_bodies_test
