#include "frames.h"

#include "arrays.h"
#include "convert.h"

#include "filasofia/core/error.h"

#include <cstddef>

namespace filasofia::python {
namespace {

using frame::AttachedPoint;
using frame::Attachment;
using frame::Cavity;
using frame::Channel;
using frame::Clip;
using frame::Contact;
using frame::Frame;
using frame::Joint;

struct Column {
    const char* name;
    const char* format; ///< in NumPy's words
    std::size_t offset;
};

/// The dtype of a row, made once: NumPy is imported with it.
template <class Row, std::size_t n> nb::handle typeOf(const Column (&columns)[n])
{
    static PyObject* made = nullptr; // for ever
    if (made) return made;
    nb::list names, formats, offsets;
    for (const Column& each : columns) {
        names.append(each.name);
        formats.append(each.format);
        offsets.append(each.offset);
    }
    nb::dict layout;
    layout["names"] = names;
    layout["formats"] = formats;
    layout["offsets"] = offsets;
    layout["itemsize"] = sizeof(Row);
    made = nb::module_::import_("numpy").attr("dtype")(layout).release().ptr();
    return made;
}

nb::handle contactType()
{
    static constexpr Column columns[] = {
        {"first", "u4", offsetof(Contact, first)},       {"second", "u4", offsetof(Contact, second)},
        {"point", "3f8", offsetof(Contact, point)},      {"normal", "3f8", offsetof(Contact, normal)},
        {"gap", "f8", offsetof(Contact, gap)},           {"normal_force", "f8", offsetof(Contact, normalForce)},
        {"friction", "3f8", offsetof(Contact, friction)}};
    return typeOf<Contact>(columns);
}
nb::handle attachmentType()
{
    static constexpr Column columns[] = {
        {"id", "u4", offsetof(Attachment, id)},          {"body", "u4", offsetof(Attachment, body)},
        {"to", "u4", offsetof(Attachment, to)},          {"force", "3f8", offsetof(Attachment, force)},
        {"torque", "3f8", offsetof(Attachment, torque)}, {"points", "i4", offsetof(Attachment, points)},
        {"broken", "?", offsetof(Attachment, broken)},   {"parted", "i4", offsetof(Attachment, parted)}};
    return typeOf<Attachment>(columns);
}
nb::handle attachedPointType()
{
    static constexpr Column columns[] = {{"attachment", "u4", offsetof(AttachedPoint, attachment)},
                                         {"node", "i4", offsetof(AttachedPoint, node)},
                                         {"place", "3f8", offsetof(AttachedPoint, place)},
                                         {"to_place", "3f8", offsetof(AttachedPoint, toPlace)}};
    return typeOf<AttachedPoint>(columns);
}
nb::handle channelType()
{
    static constexpr Column columns[] = {
        {"tissue", "u4", offsetof(Channel, tissue)},     {"needle", "u4", offsetof(Channel, needle)},
        {"inside", "u4", offsetof(Channel, inside)},     {"entry", "3f8", offsetof(Channel, entry)},
        {"end", "3f8", offsetof(Channel, end)},          {"length", "f8", offsetof(Channel, length)},
        {"through", "?", offsetof(Channel, through)},    {"force", "3f8", offsetof(Channel, force)},
        {"friction", "f8", offsetof(Channel, friction)}, {"tip", "f8", offsetof(Channel, tip)}};
    return typeOf<Channel>(columns);
}
nb::handle cavityType()
{
    static constexpr Column columns[] = {
        {"body", "u4", offsetof(Cavity, body)},       {"cavity", "i4", offsetof(Cavity, cavity)},
        {"volume", "f8", offsetof(Cavity, volume)},   {"pressure", "f8", offsetof(Cavity, pressure)},
        {"open", "?", offsetof(Cavity, open)},        {"opening", "f8", offsetof(Cavity, opening)},
        {"outflow", "f8", offsetof(Cavity, outflow)}, {"lost", "f8", offsetof(Cavity, lost)}};
    return typeOf<Cavity>(columns);
}
nb::handle clipType()
{
    static constexpr Column columns[] = {
        {"id", "u4", offsetof(Clip, id)},         {"clip", "u4", offsetof(Clip, clip)},
        {"tissue", "u4", offsetof(Clip, tissue)}, {"place", "3f8", offsetof(Clip, place)},
        {"gap", "f8", offsetof(Clip, gap)},       {"force", "f8", offsetof(Clip, force)},
        {"closed", "?", offsetof(Clip, closed)},  {"partial", "?", offsetof(Clip, partial)}};
    return typeOf<Clip>(columns);
}
nb::handle jointType()
{
    static constexpr Column columns[] = {{"position", "f8", offsetof(Joint, position)},
                                         {"velocity", "f8", offsetof(Joint, velocity)},
                                         {"force", "f8", offsetof(Joint, force)},
                                         {"load", "f8", offsetof(Joint, load)},
                                         {"stop", "f8", offsetof(Joint, stop)}};
    return typeOf<Joint>(columns);
}

/// A part of a frame; the object of the frame keeps it alive.
template <class Body> struct Part {
    nb::object frame;
    const Body* body;
};
using SoftPart = Part<frame::SoftBodyFrame>;
using RigidPart = Part<frame::RigidBodyFrame>;

nb::object bodyOf(nb::handle self, nb::handle id)
{
    const Frame& held = nb::cast<const HeldFrame&>(self).get();
    const auto body = readArgument<BodyId>(id, "frame", "body");
    if (const auto* soft = held.softBody(body)) return nb::cast(SoftPart{nb::borrow(self), soft});
    if (const auto* rigid = held.rigidBody(body)) return nb::cast(RigidPart{nb::borrow(self), rigid});
    fail("frame of step ", held.step, ": there is no body ", body.value);
}

bool hasBody(const HeldFrame& self, nb::handle id)
{
    const auto body = readArgument<BodyId>(id, "frame", "body");
    return self.get().softBody(body) || self.get().rigidBody(body);
}

/// The body that an argument of a method names; Error if the frame does not have it.
BodyId knownBody(const Frame& held, nb::handle id, const char* method, const char* name)
{
    const auto body = readArgument<BodyId>(id, method, name);
    if (!held.softBody(body) && !held.rigidBody(body))
        fail(method, ": ", name, " must be a body of the frame of step ", held.step, ", got ", body.value);
    return body;
}

bool isConnected(const HeldFrame& self, nb::handle one, nb::handle other)
{
    const Frame& held = self.get();
    const BodyId first = knownBody(held, one, "connected", "one");
    return frame::connected(first, knownBody(held, other, "connected", "other"), held.attachments);
}

nb::object contactForce(const HeldFrame& self, nb::handle of, nb::handle by)
{
    const Frame& held = self.get();
    const BodyId body = knownBody(held, of, "contact_force", "body");
    if (by.is_none()) return vectorOf(frame::forceOn(body, held.contacts));
    const BodyId other = knownBody(held, by, "contact_force", "by");
    Vec3 sum;
    for (const Contact& each : held.contacts)
        if (body != other &&
            ((each.first == body && each.second == other) || (each.first == other && each.second == body)))
            sum += frame::forceOn(body, each);
    return vectorOf(sum);
}

template <class Body> nb::list partsOf(nb::handle self, const std::vector<Body>& bodies)
{
    nb::list out;
    for (const Body& each : bodies) out.append(nb::cast(Part<Body>{nb::borrow(self), &each}));
    return out;
}

constexpr const char* kNumbers = "numpy.typing.NDArray[numpy.float64]";

/// A property that is an array with the frame as its owner.
template <class Body, class Get> void addArray(nb::class_<Part<Body>>& part, const char* name, const char* doc, Get get)
{
    const std::string signature = text("def ", name, "(self) -> ", kNumbers);
    part.def_prop_ro(
        name, [get](const Part<Body>& self) { return get(*self.body, nb::handle(self.frame)); },
        nb::for_getter(nb::sig(signature.c_str())), doc);
}

void bindSoft(nb::module_& module)
{
    nb::class_<SoftPart> soft(module, "SoftBodyFrame", "The state of a soft body. Arrays are read-only views.");
    soft.def_prop_ro(
        "id", [](const SoftPart& self) { return Convert<BodyId>::make(self.body->id); },
        nb::for_getter(nb::sig("def id(self) -> filasofia.BodyId")));
    addArray(soft, "positions", "(n, 3) [m], one row per node",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 3>(body.positions, owner); });
    addArray(soft, "velocities", "(n, 3) [m/s], one row per node",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 3>(body.velocities, owner); });
    addArray(soft, "directors", "(n - 1, 3) of a rod, one unit vector per edge across it; empty for other bodies",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 3>(body.directors, owner); });
    soft.def_prop_ro(
        "cut_edges", [](const SoftPart& self) { return rowsOf<int, 1>(self.body->cutEdges, nb::handle(self.frame)); },
        nb::for_getter(nb::sig("def cut_edges(self) -> numpy.typing.NDArray[numpy.int32]")),
        "(k,) of a rod, the edges that are gone since they were cut or torn, ascending");
    soft.def_prop_ro(
        "revision",
        [](const SoftPart& self) { return self.body->boundary ? self.body->boundary->revision : std::uint64_t{0}; },
        "How often cuts and tears have changed its mesh.");
    soft.def_prop_ro(
        "boundary",
        [](const SoftPart& self) -> nb::object {
            if (!self.body->boundary) return nb::none();
            return rowsOf<int, 3>(self.body->boundary->triangles, self.frame);
        },
        nb::for_getter(nb::sig("def boundary(self) -> numpy.typing.NDArray[numpy.int32] | None")),
        "(m, 3) nodes of its surface, which follows cuts and tears; None without dynamic_topology.");
    soft.def_prop_ro(
        "rest",
        [](const SoftPart& self) -> nb::object {
            if (!self.body->boundary) return nb::none();
            return rowsOf<double, 3>(self.body->boundary->rest, self.frame);
        },
        nb::for_getter(nb::sig("def rest(self) -> numpy.typing.NDArray[numpy.float64] | None")),
        "(n, 3) [m] where the nodes are at rest, those that cuts have made too; None without dynamic_topology.");
    soft.def("__repr__", [](const SoftPart& self) {
        return text("SoftBodyFrame(id=", self.body->id.value, ", ", self.body->positions.size(), " nodes)");
    });
}

void bindRigid(nb::module_& module)
{
    nb::class_<RigidPart> rigid(module, "RigidBodyFrame", "The state of a rigid body. Arrays are read-only views.");
    rigid.def_prop_ro(
        "id", [](const RigidPart& self) { return Convert<BodyId>::make(self.body->id); },
        nb::for_getter(nb::sig("def id(self) -> filasofia.BodyId")));
    addArray(rigid, "poses", "(n, 7) per element: position [m], then the quaternion w, x, y, z",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 7>(body.poses, owner); });
    addArray(rigid, "velocities", "(n, 3) [m/s] per element",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 3>(body.velocities, owner); });
    addArray(rigid, "angular_velocities", "(n, 3) [rad/s] per element, in world axes",
             [](const auto& body, nb::handle owner) { return rowsOf<double, 3>(body.angularVelocities, owner); });
    rigid.def_prop_ro(
        "joints", [](const RigidPart& self) { return recordsOf(self.body->joints, jointType(), self.frame); },
        nb::for_getter(nb::sig("def joints(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per joint: position, velocity, force, load, stop.");
    rigid.def("__repr__", [](const RigidPart& self) {
        return text("RigidBodyFrame(id=", self.body->id.value, ", ", self.body->poses.size(), " elements, ",
                    self.body->joints.size(), " joints)");
    });
}

void bindFrame(nb::module_& module)
{
    nb::class_<HeldFrame> whole(module, "Frame", nb::is_weak_referenceable(),
                                "The whole state after a step. It never changes, and its arrays are read-only views.");
    whole.def("__repr__", [](const HeldFrame& self) {
        return text("Frame(step=", self.get().step, ", time=", self.get().time, ")");
    });
    whole.def_prop_ro(
        "step", [](const HeldFrame& self) { return self.get().step; }, "Number of steps completed.");
    whole.def_prop_ro(
        "time", [](const HeldFrame& self) { return self.get().time; }, "[s], simulated");
    whole.def("__getitem__", &bodyOf, nb::arg("body").none(),
              nb::sig("def __getitem__(self, body: filasofia.BodyId) -> typing.Any"),
              "The SoftBodyFrame or RigidBodyFrame of a body.");
    whole.def("__contains__", &hasBody, nb::arg("body").none(), nb::sig("def __contains__(self, body: object) -> bool"),
              "Whether the body is in it.");
    whole.attr("__iter__") = nb::none(); // Python would count bodies from 0
    whole.def_prop_ro(
        "soft_bodies", [](nb::handle self) { return partsOf(self, nb::cast<const HeldFrame&>(self).get().softBodies); },
        nb::for_getter(nb::sig("def soft_bodies(self) -> list[SoftBodyFrame]")));
    whole.def_prop_ro(
        "rigid_bodies",
        [](nb::handle self) { return partsOf(self, nb::cast<const HeldFrame&>(self).get().rigidBodies); },
        nb::for_getter(nb::sig("def rigid_bodies(self) -> list[RigidBodyFrame]")));
    whole.def_prop_ro(
        "contacts",
        [](nb::handle self) { return recordsOf(nb::cast<const HeldFrame&>(self).get().contacts, contactType(), self); },
        nb::for_getter(nb::sig("def contacts(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per contact: first, second, point, normal (from the second body towards the first), gap, "
        "normal_force, friction (on the first body). The force on the first body is normal_force * normal + friction; "
        "the second gets the opposite. contact_force() sums it.");
    whole.def("contact_force", &contactForce, nb::arg("body").none(), nb::arg("by") = nb::none(),
              nb::sig("def contact_force(self, body: filasofia.BodyId, by: filasofia.BodyId | None = None) -> "
                      "numpy.typing.NDArray[numpy.float64]"),
              "(3,) [N], what contacts do to a body in the step, normal forces and friction: those with all other "
              "bodies, or only with `by`. Attachments, clips and needles are not among them.");
    whole.def_prop_ro(
        "attachments",
        [](nb::handle self) {
            return recordsOf(nb::cast<const HeldFrame&>(self).get().attachments, attachmentType(), self);
        },
        nb::for_getter(nb::sig("def attachments(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per attachment: id, body, to, force (on the body), points, broken, parted (points that let go).");
    whole.def("connected", &isConnected, nb::arg("one").none(), nb::arg("other").none(),
              nb::sig("def connected(self, one: filasofia.BodyId, other: filasofia.BodyId) -> bool"),
              "Whether attachments and grasps hold two bodies together, directly or through other bodies. Contacts, "
              "clips and needles are not among them.");
    whole.def_prop_ro(
        "attached_points",
        [](nb::handle self) {
            return recordsOf(nb::cast<const HeldFrame&>(self).get().attachedPoints, attachedPointType(), self);
        },
        nb::for_getter(nb::sig("def attached_points(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per point that holds, of attachments with point_break_force or cut_distance: attachment, node, place "
        "(on the body), to_place (on the other).");
    whole.def_prop_ro(
        "channels",
        [](nb::handle self) { return recordsOf(nb::cast<const HeldFrame&>(self).get().channels, channelType(), self); },
        nb::for_getter(nb::sig("def channels(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per channel of a needle: tissue, needle, inside, entry, end, length, through, force (on the tissue), "
        "friction, tip.");
    whole.def_prop_ro(
        "cavities",
        [](nb::handle self) { return recordsOf(nb::cast<const HeldFrame&>(self).get().cavities, cavityType(), self); },
        nb::for_getter(nb::sig("def cavities(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per cavity of a soft body: body, cavity, volume, pressure, open, opening, outflow, lost.");
    whole.def_prop_ro(
        "clips",
        [](nb::handle self) { return recordsOf(nb::cast<const HeldFrame&>(self).get().clips, clipType(), self); },
        nb::for_getter(nb::sig("def clips(self) -> numpy.typing.NDArray[numpy.void]")),
        "One row per clip on tissue: id, clip, tissue, place, gap, force, closed, partial.");
    whole.def(
        "copy", [](const HeldFrame& self) { return HeldFrame{.copy = std::make_shared<const Frame>(self.get())}; },
        "A frame of its own, which may be kept as long as you like: the engine has eight, and six may be held at "
        "once.");
}

} // namespace

HeldFrame newestFrame(const std::shared_ptr<Session>& session)
{
    // In this order: another thread may be stepping, and then the frame may be newer than the number.
    const std::uint64_t step = session->steps();
    frame::FrameRef ref = session->physics().latest();
    if (!ref) fail("frame: no step was made yet");
    // An older one means that the writer found no frame that nobody holds. A reset does not turn the number back.
    if (ref->step < step)
        fail("frame: step ", step,
             " was not captured, because too many frames (or arrays of them) were held; "
             "keep copies: frame.copy() or array.copy()");
    return {.session = session, .ref = std::move(ref)};
}

void bindFrames(nb::module_& module)
{
    bindSoft(module);
    bindRigid(module);
    bindFrame(module);
}

} // namespace filasofia::python
