#include "filasofia/scene/mjcf_bodies.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace filasofia::scene {
namespace {

using Kind = Solid::Kind;

constexpr Range kGeomSize = closed(1e-7, kFarthestShape);
constexpr int kMaxBodyDepth = 200;
constexpr double kEndless = 10.0;    // [m], half of the size at which a plane without an end is drawn
constexpr double kTouchable = 500.0; // [m], half of the size at which any plane is touched, as MuJoCo's have no end

const std::vector<std::string> kGeoms = {"plane",    "hfield", "sphere", "capsule", "ellipsoid",
                                         "cylinder", "box",    "mesh",   "sdf"};
const std::vector<std::string> kJoints = {"free", "ball", "slide", "hinge"};

bool isJoint(const Element& each) { return each.tag() == "joint" || each.tag() == "freejoint"; }

} // namespace

MjcfBodies::MjcfBodies(MjcfSource& source) : source_(source), reader_(source.reader)
{
    RigidTree& world = trees.emplace_back();
    world.def.name = "world";
    world.def.elements = {kFromZUp};
}

void MjcfBodies::read(const Element& worldbody)
{
    reader_.tellUnread(worldbody, {"childclass"});
    trees[0].place = worldbody;
    bodyPlaces.emplace("world", MjcfPlace{});
    const std::string childClass = source_.childClassOf(worldbody, {});
    const std::vector<Member> members = membersOf(worldbody, childClass);
    for (const Member& each : members)
        if (isJoint(each.element) || each.element.tag() == "inertial")
            reader_.refuse(each.element, "must stand in a body, and not in the world");
    readMembers(members, {.childClass = childClass});
}

Pose MjcfBodies::worldPose(const MjcfPlace& place)
{
    std::vector<Pose>& poses = poses_[place.tree];
    if (poses.empty()) poses = physics::elementPoses(trees[place.tree].def);
    return poses[static_cast<std::size_t>(place.link)] * place.pose;
}

geometry::Box MjcfBodies::bounds()
{
    geometry::Box box;
    for (const auto& [place, mesh] : bounded_) {
        const Pose pose = worldPose(place);
        for (const Vec3& each : mesh->vertices) box = merged(box, transform(pose, each));
    }
    return box;
}

std::vector<MjcfBodies::Member> MjcfBodies::membersOf(const Element& body, const std::string& childClass)
{
    std::vector<Member> members;
    addMembers(body, {}, childClass, members);
    std::vector<Element> elements;
    for (const Member& each : members) elements.push_back(each.element);
    reader_.refuseSecond(elements, {"inertial"});
    return members;
}

void MjcfBodies::addMembers(const Element& of, const Pose& frame, const std::string& childClass,
                            std::vector<Member>& all)
{
    if (++depth_ > kMaxBodyDepth) reader_.refuse(of, text("is nested more than ", kMaxBodyDepth, " deep"));
    for (const Element& each : source_.childrenOf(of)) {
        if (each.tag() != "frame") {
            all.push_back({each, frame, childClass});
            continue;
        }
        reader_.tellUnread(each, {"name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"});
        addMembers(each, frame * source_.poseOf(Attributes(each)), source_.childClassOf(each, childClass), all);
    }
    --depth_;
}

void MjcfBodies::readMembers(const std::vector<Member>& members, const MjcfPlace& place)
{
    using FromGeoms = MjcfCompiler::FromGeoms;
    const FromGeoms fromGeoms = source_.compiler.fromGeoms;
    const bool given = fromGeoms != FromGeoms::Always && std::ranges::any_of(members, [](const Member& each) {
                           return each.element.tag() == "inertial";
                       });
    for (const auto& [element, frame, childClass] : members) {
        const MjcfPlace at{place.tree, place.link, place.pose * frame, childClass};
        if (element.tag() == "body") {
            readBody(element, at);
        } else if (element.tag() == "geom") {
            readGeom(element, at, !given && fromGeoms != FromGeoms::Never);
        } else if (element.tag() == "inertial") {
            if (given) readInertial(element, at);
        } else if (element.tag() == "flexcomp") {
            flexes.push_back({element, at});
        } else if (element.tag() == "site") {
            readSite(element, at);
        } else if (element.tag() == "camera" || element.tag() == "light") {
            (element.tag() == "camera" ? cameras : lights).push_back({element, at});
        } else if (!isJoint(element)) {
            reader_.tellUnread(element);
        }
    }
}

void MjcfBodies::readBody(const Element& body, const MjcfPlace& outer)
{
    if (++depth_ > kMaxBodyDepth) reader_.refuse(body, text("is nested more than ", kMaxBodyDepth, " deep"));
    reader_.tellUnread(body, {"name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mocap"});
    const std::string name = reader_.word(Attributes(body), "name");
    if (!name.empty() && !bodyNames_.insert(name).second) reader_.refuse(body, "has a name that another one has");
    MjcfPlace place = outer;
    place.pose = outer.pose * source_.poseOf(Attributes(body));
    place.childClass = source_.childClassOf(body, outer.childClass);
    const std::vector<Member> members = membersOf(body, place.childClass);
    const MjcfPlace inside = enter(body, members, place);
    if (!name.empty()) bodyPlaces.emplace(name, inside);
    readMembers(members, inside);
    --depth_;
}

MjcfPlace MjcfBodies::enter(const Element& body, const std::vector<Member>& members, MjcfPlace place)
{
    std::vector<Member> own = members;
    std::erase_if(own, [](const Member& each) { return !isJoint(each.element); });
    const std::string name = reader_.word(Attributes(body), "name");
    if (place.tree == 0) { // every body that stands in the world is a tree of its own
        RigidTree& tree = trees.emplace_back();
        tree.place = body;
        tree.def.name = name.empty() ? text("body ", trees.size() - 1) : name;
        tree.def.elements = {kFromZUp * place.pose};
        place = {trees.size() - 1, 0, {}, place.childClass};
    }
    if (own.size() > 1) trees[place.tree].manyJoints = true;
    for (const auto& [joint, frame, childClass] : own) {
        const Attributes says = source_.attributesOf(joint, childClass);
        if (joint.tag() == "freejoint" || reader_.oneOf(says, "type", 3, kJoints) == 0) {
            if (joint.tag() == "freejoint") reader_.tellUnread(joint, {"name", "group", "align"});
            if (trees[place.tree].place.node != body.node || own.size() > 1)
                reader_.refuse(joint, "must be the only joint of a body that stands in the world");
            trees[place.tree].def.dynamic = true;
            for (const char* each : {"damping", "armature", "frictionloss", "stiffness"})
                if (reader_.number(says, each, 0.0) != 0.0)
                    reader_.tell(joint, text("free ", each), text("<joint> ", each, " of a free joint is not read"));
        } else {
            const bool last = joint.node == own.back().element.node;
            place = addJoint(says, frame, place, last ? name : std::string());
        }
    }
    return place;
}

MjcfPlace MjcfBodies::addJoint(const Attributes& says, const Pose& frame, const MjcfPlace& place,
                               const std::string& link)
{
    const std::size_t kind = reader_.oneOf(says, "type", 3, kJoints);
    if (kind == 1) reader_.refuse(says.element(), "is a ball joint: hinges and slides are carried, and free joints");
    const bool turns = kind == 3;
    const Vec3 pos = reader_.vector(says, "pos", {}, closed(-kFarthestShape, kFarthestShape));
    const Vec3 axis = reader_.vector(says, "axis", {0, 0, 1}, closed(-1e6, 1e6)), at = transform(frame, pos);
    if (!(length(axis) > 1e-9)) reader_.refuse(says.element(), "must have an axis of some length");
    physics::JointDef def{.kind = turns ? physics::JointKind::Revolute : physics::JointKind::Prismatic,
                          .axis = rotate(frame.orientation, axis),
                          .parent = place.link,
                          .parentOffset = place.pose * Pose{at, {}},
                          .childOffset = {at, {}},
                          .command = physics::JointForce{0.0}};
    const double ref = reader_.number(says, "ref", 0.0);
    def.start = turns ? source_.angle(ref) : ref;
    if (def.start != 0.0) { // there, the bodies are where the file says
        const Vec3 along = normalized(def.axis);
        def.parentOffset =
            def.parentOffset * (turns ? Pose{{}, axisAngle(along, -def.start)} : Pose{-def.start * along, {}});
    }
    readLimits(says, turns, def);
    if (const double stiffness = reader_.number(says, "stiffness", 0.0, closed(0, 1e12)); stiffness > 0.0) {
        const double rest = reader_.number(says, "springref", 0.0);
        def.command = physics::JointSpring{.value = turns ? source_.angle(rest) : rest, .stiffness = stiffness};
    }
    def.damping = reader_.number(says, "damping", 0.0, closed(0, 1e12));
    def.friction = reader_.number(says, "frictionloss", 0.0, closed(0, 1e12));
    def.inertia = reader_.number(says, "armature", 0.0, closed(0, 1e12));
    RigidTree& tree = trees[place.tree];
    references[{place.tree, tree.def.articulation.joints.size()}] = turns ? source_.angle(ref) : ref;
    const std::string jointName = reader_.word(says, "name");
    const int element = tree.add(def, jointName, link);
    if (!jointName.empty() && !joints.emplace(jointName, std::pair{place.tree, tree.links() - 2}).second)
        reader_.refuse(says.element(), "has a name that another one has");
    return {place.tree, element, {}, place.childClass};
}

void MjcfBodies::readLimits(const Attributes& says, bool turns, physics::JointDef& def) const
{
    const auto range = says.find("range");
    const std::vector<double> v = range ? reader_.numbers(*range, 2, 2) : std::vector<double>();
    const bool limited = range && source_.compiler.autoLimits && v[0] < v[1]; // "0 0" means no limit
    const std::size_t says3 = reader_.oneOf(says, "limited", 2, {"false", "true", "auto"});
    if (says3 == 0 || (says3 == 2 && !limited)) return;
    if (!range) reader_.refuse(says.element(), "must say its range, because it is limited");
    def.lower = turns ? source_.angle(v[0]) : v[0];
    def.upper = turns ? source_.angle(v[1]) : v[1];
    if (def.lower > def.upper) reader_.refuse(*range, "must be ascending");
    if (def.start < def.lower || def.start > def.upper) {
        reader_.note(says.element(), "joint.start", "<joint> starts at its limit: where the file has it, it is beyond");
        def.start = std::clamp(def.start, def.lower, def.upper);
    }
}

void MjcfBodies::readInertial(const Element& element, const MjcfPlace& place)
{
    reader_.tellUnread(element,
                       {"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "mass", "diaginertia", "fullinertia"});
    const Attributes says(element);
    reader_.refuseSecond(element, {"diaginertia", "fullinertia"});
    for (const char* way : {"quat", "axisangle", "euler", "xyaxes", "zaxis"})
        reader_.refuseSecond(element, {"fullinertia", way}); // a full tensor is in the body's axes
    if (!says.has("mass") || !says.has("pos")) reader_.refuse(element, "must say its mass and pos");
    physics::RigidInertia inertia{.mass = reader_.number(says, "mass", 0.0, closed(0, 1e9))};
    Pose pose = source_.poseOf(says);
    if (const auto full = says.find("fullinertia")) {
        const std::vector<double> v = reader_.numbers(*full, 6, 6);
        inertia.inertia = {{{v[0], v[3], v[4]}, {v[3], v[1], v[5]}, {v[4], v[5], v[2]}}};
    } else if (says.has("diaginertia")) {
        inertia.inertia = Mat3::diagonal(reader_.vector(says, "diaginertia", {}));
    } else
        reader_.refuse(element, "must say its diaginertia or fullinertia");
    trees[place.tree].addInertia(place.link, moved(place.pose * pose, inertia), element);
}

void MjcfBodies::noteUnused(const Attribute& before, std::initializer_list<const char*> names) const
{
    for (const char* name : names)
        if (before.at.has(name))
            reader_.note(before.at, text("geom.", before.name, name),
                         text("<geom> ", name, " is not used beside ", before.name, ", as in MuJoCo"));
}

Solid MjcfBodies::planeOf(const Attributes& says, Pose& pose, bool touched) const
{
    const auto given = says.find("size");
    if (!given) reader_.refuse(says.element(), "must say its size");
    const std::vector<double> size = reader_.numbers(*given, 3, 3, closed(0, kFarthestShape));
    // A slab whose upper side is the plane: thick enough that nothing gets through.
    const auto halfOf = [touched](double side) {
        return touched ? std::max(side, kTouchable) : side > 0.0 ? side : kEndless;
    };
    const Vec3 half{halfOf(size[0]), halfOf(size[1]), 0.0};
    const double thick = 0.05 * std::max(half.x, half.y);
    pose = pose * Pose{{0, 0, -thick}, {}};
    return {Kind::Box, {half.x, half.y, thick}};
}

std::optional<Solid> MjcfBodies::solidOf(const Attributes& says, Pose& pose)
{
    const bool mesh = says.has("mesh");
    const auto ends = says.find("fromto");
    const std::size_t kind = reader_.oneOf(says, "type", mesh ? 7 : 2, kGeoms);
    if (ends && (kind < 3 || kind > 6)) reader_.refuse(*ends, "needs a capsule, ellipsoid, cylinder or box");
    if (kind == 0) return planeOf(says, pose, false);
    if (kind == 1 || kind == 8) {
        reader_.tell(says.element(), kGeoms[kind], text("<geom> of type ", kGeoms[kind], " is not read"));
        return {};
    }
    if (kind == 7) {
        if (!mesh) reader_.refuse(says.element(), "must say its mesh");
        return Solid{Kind::Mesh, {}, source_.meshOf(*says.find("mesh"))};
    }
    if (mesh) reader_.refuse(*says.find("mesh"), "must not stand beside a shape that MuJoCo would fit to it");
    const auto given = says.find("size");
    if (!given) reader_.refuse(says.element(), "must say its size");
    const bool round = kind == 3 || kind == 5;
    const std::size_t needs = kind == 2 || ends ? 1 : round ? 2 : 3;
    std::vector<double> size;
    for (const Attribute& each : says.findAll("size")) { // the first numbers of a default may be replaced alone
        const std::vector<double> more = reader_.numbers(each, 1, 3, closed(0, kFarthestShape));
        if (more.size() > size.size())
            size.insert(size.end(), more.begin() + static_cast<std::ptrdiff_t>(size.size()), more.end());
    }
    if (size.size() < needs) reader_.refuse(*given, text("must be ", needs < 3 ? "at least " : "", needs, " numbers"));
    size.resize(3);
    double half = size[1];
    if (ends) {
        const std::vector<double> v = reader_.numbers(*ends, 6, 6, closed(-kFarthestShape, kFarthestShape));
        const Vec3 a{v[0], v[1], v[2]}, b{v[3], v[4], v[5]}, axis = a - b;
        if (!(length(axis) > 1e-7)) reader_.refuse(*ends, "must be two points apart");
        half = 0.5 * length(axis);
        if (pose.position != Vec3{}) reader_.refuse(*says.find("pos"), "must not stand beside fromto");
        pose = {0.5 * (a + b), turnOfZ(normalized(axis))};
        noteUnused(*ends, {"quat", "axisangle", "euler", "xyaxes", "zaxis"});
    }
    Solid solid{Kind::Box, {size[0], ends ? size[0] : size[1], ends ? half : size[2]}};
    if (kind == 2) solid = {Kind::Sphere, {size[0], size[0], size[0]}};
    if (kind == 3) solid = {Kind::Capsule, {size[0], size[0], half}};
    if (kind == 4) solid.kind = Kind::Ellipsoid;
    if (kind == 5) solid = {Kind::Cylinder, {size[0], size[0], half}};
    for (int k = 0; k < 3; ++k)
        if (!kGeomSize.contains(solid.half[k])) reader_.refuse(*given, kGeomSize.text("m"));
    return solid;
}

void MjcfBodies::weigh(const Attributes& says, const Solid& solid, const MjcfPlace& place)
{
    try {
        const std::string name = says.element().path();
        if (const auto given = says.find("mass")) noteUnused(*given, {"density"});
        const double density = reader_.number(says, "density", 1000.0, closed(0, 1e9));
        const double mass =
            says.has("mass") ? reader_.number(says, "mass", 0.0, closed(0, 1e9)) : density * volumeOf(solid, name);
        if (!(mass > 0.0)) return;
        trees[place.tree].addInertia(place.link, moved(place.pose, inertiaOf(solid, mass, name)), says.element());
    } catch (const Error& error) { // a mesh without an inside
        const std::string line = error.what(), at = says.element().place();
        fail(line.starts_with(at) ? "" : at + ": ", line);
    }
}

ContactBits contactBitsOf(XmlReader& reader, const Attributes& says)
{
    const auto bits = [&](const char* name) {
        return static_cast<unsigned>(reader.whole(says, name, 1, closed(0, 2147483647)));
    };
    return {bits("contype"), bits("conaffinity")};
}

std::optional<int> groupOf(XmlReader& reader, const Attributes& says)
{
    const auto [type, affinity] = contactBitsOf(reader, says);
    const unsigned all = type | affinity;
    if (all == 0) return {};
    if (type != affinity || !std::has_single_bit(type))
        reader.note(says.element(), "contype", "contype and conaffinity are read as one group, the lowest bit of both");
    return std::countr_zero(all);
}

double frictionOf(XmlReader& reader, const Attributes& says)
{
    const auto found = says.find("friction");
    if (!found) return 1.0;
    const std::vector<double> v = reader.numbers(*found, 1, 3, closed(0, 1e6));
    if (v.size() > 1)
        reader.note(found->at, "friction",
                    "friction is read without its second and third number, of torsion and rolling");
    return v[0];
}

void MjcfBodies::collide(const Attributes& says, const std::shared_ptr<const geometry::TriangleMesh>& mesh,
                         const MjcfPlace& place)
{
    const auto group = groupOf(reader_, says);
    if (!group) return;
    RigidTree& tree = trees[place.tree];
    const ContactBits bits = contactBitsOf(reader_, says);
    tree.types |= bits.type;
    tree.affinities |= bits.affinity;
    physics::RigidBodyDef& def = tree.def;
    const double friction = frictionOf(reader_, says);
    if (rubbed_.insert(place.tree).second)
        def.friction = friction;
    else if (def.friction != friction) {
        reader_.note(says.element(), "geom.friction", "a body has one friction: the largest one of its geoms");
        def.friction = std::max(def.friction, friction);
    }
    def.collision.push_back({.mesh = mesh, .element = place.link, .group = *group});
}

void MjcfBodies::readGeom(const Element& element, const MjcfPlace& outer, bool weighs)
{
    const Attributes says = source_.attributesOf(element, outer.childClass);
    if (++shapes_ > kMostShapes) reader_.refuse(element, text("is one of more than ", kMostShapes, " shapes"));
    const Pose own = source_.poseOf(says);
    Pose pose = own; // that of a plane becomes the middle of its slab
    const bool plane = reader_.oneOf(says, "type", 2, kGeoms) == 0;
    const auto solid = solidOf(says, pose);
    if (!solid) return;
    MjcfPlace place = outer;
    place.pose = outer.pose * pose;
    if (const std::string name = reader_.word(says, "name"); !name.empty())
        geomPlaces.emplace(name,
                           MjcfPlace{outer.tree, outer.link, outer.pose * (plane ? own : pose), outer.childClass});
    const auto surface = surfaceOf(*solid, place.pose);
    RigidTree& tree = trees[place.tree];
    const MjcfSource::Look look = source_.lookOf(says);
    const int group = reader_.whole(says, "group", 0, closed(0, 1000));
    if (!look.hidden && group <= 2) // MuJoCo draws these groups if one asks for nothing else
        tree.show.push_back(
            {.surface = surface,
             .element = place.link,
             .material = look.material.value_or(plainMaterial(plane ? Vec3{0.35, 0.4, 0.45} : Vec3{0.5, 0.5, 0.5}))});
    if (plane) {
        Pose middle = own;
        const Solid slab = planeOf(says, middle, true);
        collide(says, surfaceOf(slab, outer.pose * middle), place);
        return;
    }
    bounded_.emplace_back(MjcfPlace{place.tree, place.link, {}, {}}, surface);
    collide(says, surface, place);
    if (weighs && (tree.def.dynamic || place.link > 0)) weigh(says, *solid, place);
}

void MjcfBodies::readSite(const Element& element, const MjcfPlace& outer)
{
    const Attributes says = source_.attributesOf(element, outer.childClass);
    MjcfPlace place = outer;
    place.pose = outer.pose * source_.poseOf(says);
    if (const auto ends = says.find("fromto")) {
        const std::vector<double> v = reader_.numbers(*ends, 6, 6, closed(-kFarthestShape, kFarthestShape));
        place.pose = outer.pose * Pose{0.5 * Vec3{v[0] + v[3], v[1] + v[4], v[2] + v[5]}, {}};
    }
    reader_.note(element, "site", "<site> is a place that sensors may name, and is not drawn");
    if (const std::string name = reader_.word(says, "name"); !name.empty() && !sitePlaces.emplace(name, place).second)
        reader_.refuse(element, "has a name that another one has");
}

} // namespace filasofia::scene
